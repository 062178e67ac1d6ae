// SPDX-License-Identifier: Apache-2.0
// servo/devices/space_mouse_report.hpp: the reports of 3Dconnexion's SpaceMouse family, as bytes.
//
// Report 1: three 16-bit integers, the low byte first: how far the cap is pushed along x (right), y (towards the user)
// and z (down), up to some +-350; newer devices add three for how far it is turned. Report 2: the turn alone, of older
// devices. Report 3: buttons, a bit each. A device at rest sends zeros and then nothing. Source of the layouts:
// spacenavd (src/dev.c), PySpaceMouse (devices.toml) and vrpn (vrpn_3DConnexion.C). Any thread; no heap.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace palpate {

// What one report says. Parts that it says nothing of are empty.
struct SpaceMouseState {
  std::optional<std::array<std::int16_t, 3>> push{};  // along the device's x, y, z
  std::optional<std::array<std::int16_t, 3>> turn{};  // about them
  std::optional<std::uint32_t> buttons{};             // a bit each

  bool operator==(const SpaceMouseState&) const = default;
};

inline constexpr int kSpaceMouseFullPush = 350;

// `report` begins with its number. Empty: no report of a SpaceMouse, by its number or length.
[[nodiscard]] std::optional<SpaceMouseState> parseSpaceMouse(std::span<const std::uint8_t> report) noexcept;

}  // namespace palpate
