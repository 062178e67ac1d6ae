// SPDX-License-Identifier: Apache-2.0
// servo/safety/faults.hpp: everything that can go wrong in a tick, as bits, and a table that describes each bit.
//
// The servo only raises bits. Texts are made from them after the run or by another thread. Thread: the bits may be used
// anywhere; the text functions allocate, so not in the servo. Errors: none.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace palpate {

enum class ServoFault : std::uint32_t {
  kNone = 0,
  // The values are fixed, since traces hold them. Bits in kFadingFaults take the force away (safety_gate.hpp). The
  // others are notes: the force goes on, limited where the name says so.
  kNoWindow = 1U << 0,
  kStaleWindow = 1U << 1,
  kBeyondWindow = 1U << 2,
  kNonFiniteForce = 1U << 3,
  kDeviceError = 1U << 4,
  kForceLimited = 1U << 5,
  kSlewLimited = 1U << 6,
  kOverrun = 1U << 7,
  kZeroGradient = 1U << 8,
  kInsideObject = 1U << 9,
  kSurfaceLost = 1U << 10,
  kStall = 1U << 11,
  kDroppedReports = 1U << 12,
  kClockStep = 1U << 13,
  kPlaneBehind = 1U << 14,
  kUnstable = 1U << 15,
  kForceOff = 1U << 16,
  kCalibrationRefused = 1U << 17,
};

[[nodiscard]] constexpr std::uint32_t bit(ServoFault fault) noexcept {
  return static_cast<std::uint32_t>(fault);
}
[[nodiscard]] constexpr bool has(std::uint32_t faults, ServoFault fault) noexcept {
  return (faults & bit(fault)) != 0;
}

// The bits that take the force away.
inline constexpr std::uint32_t kFadingFaults =
    bit(ServoFault::kNoWindow) | bit(ServoFault::kStaleWindow) | bit(ServoFault::kBeyondWindow) |
    bit(ServoFault::kNonFiniteForce) | bit(ServoFault::kDeviceError) | bit(ServoFault::kStall) |
    bit(ServoFault::kDroppedReports) | bit(ServoFault::kClockStep) | bit(ServoFault::kSurfaceLost) |
    bit(ServoFault::kPlaneBehind) | bit(ServoFault::kUnstable) | bit(ServoFault::kForceOff);

struct FaultText {
  ServoFault fault;
  const char* name;    // as in trace.csv and reports
  const char* text;    // what happened
  const char* effect;  // what it does to the force, and how the force comes back
  const char* remedy;  // what to do
};

// One row for each bit, lowest bit first.
[[nodiscard]] std::span<const FaultText> faultTable() noexcept;

// The set bits by name, "beyond-window force-limited"; "none" for none. A bit without a row becomes "unknown-fault".
[[nodiscard]] std::string faultNames(std::uint32_t faults);

// One line for each set bit: "name: text; effect; remedy". Empty for none.
[[nodiscard]] std::string describeFaults(std::uint32_t faults);

// The table as docs/faults.md has it and `palpate faults` prints it.
[[nodiscard]] std::string faultDocument();

}  // namespace palpate
