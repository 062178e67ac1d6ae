// SPDX-License-Identifier: Apache-2.0
// Sizes of memory as text: what is read comes back from its own words.
#include "base/byte_size.hpp"

#include "fuzz_target.hpp"

namespace {

using namespace palpate;

void check(const std::string& text) {
  std::uint64_t bytes = 0;
  if (!fuzz::accepts("--history", [&] { bytes = byteSize(text, "--history"); })) return;
  fuzz::require(bytes < std::uint64_t{1} << 63U, "it is 2^63 bytes or more");
  // A number of bytes that is no multiple of 1024 is written whole, and read as a double, which holds 2^53 of them.
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
