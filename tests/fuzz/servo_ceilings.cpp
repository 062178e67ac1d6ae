// SPDX-License-Identifier: Apache-2.0
// The file of a servo's ceilings as a user may write it. What is accepted is within its range, and the same when it is
// written again.
#include "apps/servo_side/servo_ceilings.hpp"

#include <fmt/format.h>

#include "fuzz_target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  const std::string text = fuzz::textOf(data, size);
  ServoCeilings ceilings;
  if (!fuzz::accepts("servo.toml", [&] { ceilings = readCeilings(text, "servo.toml"); })) return 0;
  std::string again;
  for (const CeilingRow& row : ceilingRows()) {
    const std::optional<double>& value = ceilings.*row.member;
    if (!value) continue;
    fuzz::require(*value >= row.lowest && *value <= row.highest, "a value out of range is accepted");
    again += fmt::format("{} = {:.17e}\n", row.key, *value);
  }
  fuzz::require(readCeilings(again, "servo.toml") == ceilings, "it reads otherwise when it is written again");
  return 0;
}
