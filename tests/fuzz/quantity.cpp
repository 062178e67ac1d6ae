// SPDX-License-Identifier: Apache-2.0
// Forces with a unit, and times behind a 't'. One that is accepted is above zero and finite and, written as text and
// read again, the same.
#include "apps/tune/quantity.hpp"

#include <cmath>

#include "fuzz_target.hpp"

namespace {

using namespace palpate;

using Read = double (*)(const std::string& text, const std::string& where);
using Write = std::string (*)(double value);

void check(const std::string& text, const std::string& flag, Read read, Write write) {
  double value = 0;
  if (!fuzz::accepts(flag, [&] { value = read(text, flag); })) return;
  fuzz::require(value > 0 && std::isfinite(value), "it is not above zero and finite");
  fuzz::mustAccept("its own words are refused", [&] {
    fuzz::require(read(write(value), flag) == value, "it reads otherwise from " + write(value));
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text = fuzz::textOf(data, size);
  if (text.starts_with('t')) {
    check(text.substr(1), "--budget", timeOf_us, timeText);
  } else {
    check(text, "--error", forceOf_N, forceText);
  }
  return 0;
}
