// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/entries.hpp"
#include "servo/devices/parameter_rows.hpp"
#include "servo/devices/space_mouse_device.hpp"

namespace palpate {
namespace {

using Mouse = SpaceMouseParameters;

// clang-format off
constexpr ParameterRow<Mouse> kSpaceMouseRows[] = {
    memberRow<Mouse, &Mouse::fastest_m_per_s>("fastest_m_per_s", "m/s", 1e-4, 10, "speed of a full push"),
    memberRow<Mouse, &Mouse::dead_share>("dead_share", "", 0, 0.9, "pushes that are a smaller share of a full one count as none"),
    memberRow<Mouse, &Mouse::smooth_s>("smooth_s", "s", 1e-4, 1, "time in which the velocity follows the push"),
    memberRow<Mouse, &Mouse::interval_s>("interval_s", "s", 1e-4, 0.1, "time between two reports while it is pushed"),
    memberRow<Mouse, &Mouse::silence_s>("silence_s", "s", 1e-3, 10, "after a silence of this time the push is none"),
    memberRow<Mouse, &Mouse::workspace_radius_m>("workspace_radius_m", "m", 1e-3, 100, "the farthest that it goes from where it began"),
};
// clang-format on

std::unique_ptr<Device> makeSpaceMouse(const DeviceSetup& setup) {
  const SpaceMouseUse use{
      .simulated_clock = setup.simulated_clock, .rate_hz = setup.rate_hz, .thread_begins = setup.thread_begins};
  return std::make_unique<SpaceMouseDevice>(given<Mouse>(kSpaceMouseRows, setup), use, setup.open);
}

}  // namespace

DeviceEntry spaceMouseEntry() {
  return {
      .name = "spacemouse-family",
      .description = "3Dconnexion SpaceMouse over HID: moves the tool, exerts no force",
      .needs_port = true,
      .parameters = parametersOf<kSpaceMouseRows>,
      .make = makeSpaceMouse,
      .check = [](const DeviceValues& values) { checkSpaceMouse(given<Mouse>(kSpaceMouseRows, {.values = values})); }};
}

}  // namespace palpate
