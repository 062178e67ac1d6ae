// SPDX-License-Identifier: Apache-2.0
// The walk over a DICOM file's elements: what is called whole is not whole any more without its last byte, nor with
// bytes behind it.
#include "engine/volume/dicom_structure.hpp"

#include "fuzz_target.hpp"

namespace {

using namespace palpate;

// Deflated and big endian files are let through unwalked; whoever names their syntax is one.
bool mayBeUnwalked(std::string_view file) {
  return file.find("1.2.840.10008.1.2.1.99") != std::string_view::npos ||
         file.find("1.2.840.10008.1.2.2") != std::string_view::npos;
}

void check(std::string_view file) {
  fuzz::verdict = dicomIsWhole(file) ? fuzz::Verdict::kAccepted : fuzz::Verdict::kRefused;
  if (fuzz::verdict == fuzz::Verdict::kRefused || mayBeUnwalked(file)) return;
  constexpr std::size_t kPreamble = 132;
  if (file.size() - 1 > kPreamble)
    fuzz::require(!dicomIsWhole(file.substr(0, file.size() - 1)), "without its last byte it is whole too");
  // No element is so short, and 0xff... is no tag.
  for (const std::string_view more : {std::string_view("x"), std::string_view("\xff\xff\xff\xff\xff\xff\xff\xff")})
    fuzz::require(!dicomIsWhole(std::string(file) + std::string(more)), "with bytes behind it it is whole too");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  check(fuzz::textOf(data, size));
  return 0;
}
