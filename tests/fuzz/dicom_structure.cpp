// SPDX-License-Identifier: Apache-2.0
// The walk over a DICOM file's elements: what is called whole is not whole any more without its last byte, nor with
// bytes behind it.
#include "engine/files/dicom_structure.hpp"

#include "fuzz_target.hpp"

namespace {

using namespace palpate;

// A deflated file may have one byte of 0 behind its data, which it can do without; whoever names its syntax is one.
bool mayBePadded(std::string_view file) {
  return file.find("1.2.840.10008.1.2.1.99") != std::string_view::npos && file.ends_with('\0');
}

void check(std::string_view file) {
  fuzz::verdict = dicomIsWhole(file) ? fuzz::Verdict::kAccepted : fuzz::Verdict::kRefused;
  if (fuzz::verdict == fuzz::Verdict::kRefused) return;
  if (!mayBePadded(file)) {
    fuzz::require(!dicomIsWhole(file.substr(0, file.size() - 1)), "without its last byte it is whole too");
  }
  fuzz::require(!dicomIsWhole(file.substr(0, file.size() - 2)), "without its last two bytes it is whole too");
  // No element is so short, and 0xff... is no tag.
  for (const std::string_view more : {std::string_view("x"), std::string_view("\xff\xff\xff\xff\xff\xff\xff\xff")})
    fuzz::require(!dicomIsWhole(std::string(file) + std::string(more)), "with bytes behind it it is whole too");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  check(fuzz::textOf(data, size));
  return 0;
}
