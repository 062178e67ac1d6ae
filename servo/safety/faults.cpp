// SPDX-License-Identifier: Apache-2.0
#include "servo/safety/faults.hpp"

#include <array>

#include <fmt/format.h>

namespace palpate {
namespace {

constexpr std::array kTable = {
    FaultText{ServoFault::kNoWindow, "no-window", "no samples have been published yet",
              "let the engine publish the first window before the tool moves"},
    FaultText{ServoFault::kStaleWindow, "stale-window", "the engine has not confirmed the samples in time",
              "look for an engine that hangs or is overloaded, or allow an older window"},
    FaultText{ServoFault::kBeyondWindow, "beyond-window", "the tool was where the window holds no samples",
              "make the window larger, publish more often, or move more slowly"},
    FaultText{ServoFault::kNonFiniteForce, "non-finite-force", "the algorithm gave a force that is not a number",
              "report it with the scene and the trace: it is an error in the program"},
    FaultText{ServoFault::kDeviceError, "device-error", "the device could not be read or written",
              "check its cable and power, then start again"},
    FaultText{ServoFault::kForceLimited, "force-limited", "the force was cut to the device's maximum",
              "lower the stiffness, or press less deep"},
    FaultText{ServoFault::kSlewLimited, "slew-limited", "the force changed faster than allowed and was held back",
              "lower the stiffness or n, or use a recovery time"},
    FaultText{ServoFault::kOverrun, "overrun", "a tick was not done when the next one was due",
              "lower the rate, or give the servo a core and real-time priority"},
    FaultText{ServoFault::kZeroGradient, "zero-gradient", "the field is flat at the surface, so it gives no normal",
              "smooth the volume, or choose an isovalue between two densities"},
    FaultText{ServoFault::kInsideObject, "inside-object", "the tool was inside the object without having entered it",
              "move the tool out once; contact begins from outside"},
    FaultText{ServoFault::kSurfaceLost, "surface-lost", "the surface that was touched could not be found again",
              "expected where an edit removes it; otherwise lower n"},
};

void append(std::string& names, const char* name) {
  if (!names.empty()) names += ' ';
  names += name;
}

}  // namespace

std::span<const FaultText> faultTable() noexcept {
  return kTable;
}

std::string faultNames(std::uint32_t faults) {
  std::string names;
  for (const FaultText& row : kTable) {
    if (has(faults, row.fault)) append(names, row.name);
    faults &= ~bit(row.fault);
  }
  if (faults != 0) append(names, "unknown-fault");
  return names.empty() ? "none" : names;
}

std::string describeFaults(std::uint32_t faults) {
  std::string lines;
  for (const FaultText& row : kTable) {
    if (has(faults, row.fault)) lines += fmt::format("{}: {}; {}\n", row.name, row.text, row.remedy);
  }
  return lines;
}

}  // namespace palpate
