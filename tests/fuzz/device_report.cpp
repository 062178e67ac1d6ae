// SPDX-License-Identifier: Apache-2.0
// A report as a device may send it: of a Polhem with 14 and 64 bytes, of a SpaceMouse. What is accepted is what was
// sent.
#include "base/error.hpp"
#include "fuzz_target.hpp"
#include "servo/devices/polhem_report.hpp"
#include "servo/devices/space_mouse_report.hpp"

namespace {

using namespace palpate;

void checkPolhem(std::span<const std::uint8_t> bytes, std::size_t report_bytes) {
  const auto state = parsePolhem(bytes, report_bytes);
  fuzz::require(!state || bytes.size() == report_bytes, "a report of another length is accepted");
  if (!state) return;
  const Report again = polhemStateReport(*state, report_bytes);
  fuzz::require(std::equal(bytes.begin(), bytes.begin() + kPolhemBytes, again.bytes.begin()), "it reads otherwise");
}

void checkCommand(std::span<const std::uint8_t> bytes, std::size_t report_bytes) {
  const auto command = parsePolhemCommand(bytes, report_bytes);
  if (!command) return;
  const Report again = polhemReport(*command, report_bytes);
  fuzz::require(parsePolhemCommand(again.content().subspan(1), report_bytes) == command, "it reads otherwise");
}

void checkSpaceMouse(std::span<const std::uint8_t> bytes) {
  const auto state = parseSpaceMouse(bytes);
  if (!state) return;
  fuzz::require(state->push || state->turn || state->buttons, "it says nothing");
  fuzz::require(bytes[0] >= 1 && bytes[0] <= 3, "an unknown report is accepted");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span<const std::uint8_t> bytes(data, size);
  for (const std::size_t report_bytes : {std::size_t{14}, std::size_t{64}}) {
    checkPolhem(bytes, report_bytes);
    checkCommand(bytes, report_bytes);
  }
  checkSpaceMouse(bytes);
  const bool is_one = parsePolhem(bytes, 14) || parsePolhem(bytes, 64) || parseSpaceMouse(bytes);
  static_cast<void>(fuzz::accepts("report", [&] {
    if (!is_one) throw Error(Error::Code::kBadInput, "report", "it is none of a device", "send another");
  }));
  return 0;
}
