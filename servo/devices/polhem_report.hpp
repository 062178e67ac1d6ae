// SPDX-License-Identifier: Apache-2.0
// servo/devices/polhem_report.hpp: the reports of Polhem and WoodenHaptics, as bytes.
//
// Both ways seven 16-bit integers, the low byte first (14 bytes); firmwares on Teensy boards send them at the front of
// reports of 64 bytes, which end with bytes that mean nothing.
//   from the device: encoders a to f [count]; info: 1 after the button for calibration was pressed, else 0.
//   to the device:   currents a to c [mA]; command; three numbers that belong to it. Command 0: apply the currents.
//                    Command 1: count from these numbers (a to c), and from the currents' places (d to f), with no
//                    current until the next report.
// A handle may have a switch, which adds 10000 to encoder d. Source: the firmware and the protocol's header of
// Haptikfabriken's API (github.com/forsslund/haptikfabrikenapi, firmware/main.cpp, src/fsusbhapticdevicethread.h).
// Any thread; no heap; no errors but an empty result.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "servo/devices/report_port.hpp"

namespace palpate {

inline constexpr std::size_t kPolhemBytes = 14;  // of a report that mean something

using PolhemCounts = std::array<std::int16_t, 6>;  // encoders a to f [count]

struct PolhemState {
  PolhemCounts counts{};
  bool asks_for_calibration = false;
  bool pressed = false;  // the handle's switch

  bool operator==(const PolhemState&) const = default;
};

// Empty: no report of a Polhem. It has another length than `report_bytes` (14 or 64), or an info that is neither 0 nor
// 1.
[[nodiscard]] std::optional<PolhemState> parsePolhem(std::span<const std::uint8_t> report,
                                                     std::size_t report_bytes) noexcept;
// What a device sends: the inverse of parsePolhem, for emulations. Without the report's number in front.
[[nodiscard]] Report polhemStateReport(const PolhemState& state, std::size_t report_bytes) noexcept;

struct PolhemCommand {
  std::array<std::int16_t, 3> currents_mA{};  // of motors a to c
  std::optional<PolhemCounts> count_from{};   // instead of currents

  bool operator==(const PolhemCommand&) const = default;
};

// With the report's number, 0, in front.
[[nodiscard]] Report polhemReport(const PolhemCommand& command, std::size_t report_bytes) noexcept;
// The inverse, for emulations: what a device reads, without the number. Empty: another length, or no such command.
[[nodiscard]] std::optional<PolhemCommand> parsePolhemCommand(std::span<const std::uint8_t> report,
                                                              std::size_t report_bytes) noexcept;

}  // namespace palpate
