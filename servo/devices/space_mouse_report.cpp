// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/space_mouse_report.hpp"

#include <algorithm>

namespace palpate {
namespace {

constexpr std::uint8_t kPush = 1, kTurn = 2, kButtons = 3;
constexpr std::size_t kTripleBytes = 6;
constexpr std::size_t kMostButtonBytes = 12;  // a SpaceMouse Enterprise sends 6, some firmwares pad

std::array<std::int16_t, 3> triple(std::span<const std::uint8_t> bytes) noexcept {
  std::array<std::int16_t, 3> values{};
  for (std::size_t i = 0; i < 3; ++i)
    values[i] = static_cast<std::int16_t>(static_cast<std::uint16_t>(bytes[2 * i] | bytes[2 * i + 1] << 8U));
  return values;
}

}  // namespace

std::optional<SpaceMouseState> parseSpaceMouse(std::span<const std::uint8_t> report) noexcept {
  if (report.empty()) return {};
  const std::span<const std::uint8_t> content = report.subspan(1);
  SpaceMouseState state;
  if (report[0] == kPush && (content.size() == kTripleBytes || content.size() == 2 * kTripleBytes)) {
    state.push = triple(content);
    if (content.size() > kTripleBytes) state.turn = triple(content.subspan(kTripleBytes));
    return state;
  }
  if (report[0] == kTurn && content.size() == kTripleBytes) {
    state.turn = triple(content);
    return state;
  }
  if (report[0] == kButtons && !content.empty() && content.size() <= kMostButtonBytes) {
    state.buttons = 0;
    for (std::size_t i = 0; i < std::min<std::size_t>(4, content.size()); ++i)
      *state.buttons |= static_cast<std::uint32_t>(content[i]) << (8 * i);
    return state;
  }
  return {};
}

}  // namespace palpate
