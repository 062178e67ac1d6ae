// SPDX-License-Identifier: Apache-2.0
// Sizes of memory as text. A size that is accepted, written as text and read again, is the same.
#include "base/byte_size.hpp"

#include "fuzz_target.hpp"

namespace {

using namespace palpate;

void check(const std::string& text) {
  std::uint64_t bytes = 0;
  if (!fuzz::accepts("--history", [&] { bytes = byteSize(text, "--history"); })) return;
  fuzz::require(bytes < std::uint64_t{1} << 63U, "it is 2^63 bytes or more");
  // Other numbers of bytes than multiples of 1024 are written in full. They are read as doubles, which are exact to
  // 2^53.
  if (bytes > std::uint64_t{1} << 53U) return;
  fuzz::mustAccept("its own words are refused", [&] {
    fuzz::require(byteSize(byteSizeText(bytes), "") == bytes, "it reads otherwise from " + byteSizeText(bytes));
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  check(fuzz::textOf(data, size));
  return 0;
}
