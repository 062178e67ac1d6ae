// SPDX-License-Identifier: Apache-2.0
// The walk over a DICOM file's elements. A file that it accepts as complete must be refused without its last byte, and
// with bytes added at its end.
#include "engine/files/dicom_structure.hpp"

#include "fuzz_target.hpp"

namespace {

using namespace palpate;

// A deflated file may have one padding byte of 0 after its data. Every file that names the deflated syntax counts as
// one.
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
  // No element is this short, and 0xff... is no tag.
  for (const std::string_view more : {std::string_view("x"), std::string_view("\xff\xff\xff\xff\xff\xff\xff\xff")})
    fuzz::require(!dicomIsWhole(std::string(file) + std::string(more)), "with bytes behind it it is whole too");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  check(fuzz::textOf(data, size));
  return 0;
}
