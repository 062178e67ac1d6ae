// SPDX-License-Identifier: Apache-2.0
#include "servo/safety/faults.hpp"

#include <array>

#include "base/formatted.hpp"

namespace palpate {
namespace {

// The effect of most faults.
constexpr const char* kFades =
    "falls to zero within the fade time while it lasts, then grows back within the fade time";

constexpr std::array kTable = {
    FaultText{ServoFault::kNoWindow, "no-window", "no samples have been published yet", kFades,
              "let the engine publish the first window before the tool moves"},
    FaultText{ServoFault::kStaleWindow, "stale-window", "the engine has not confirmed the samples in time", kFades,
              "look for an engine that hangs or is overloaded, or allow an older window"},
    FaultText{ServoFault::kBeyondWindow, "beyond-window", "the tool was where the window holds no samples", kFades,
              "make the window larger, publish more often, or move more slowly"},
    FaultText{ServoFault::kNonFiniteForce, "non-finite-force", "the algorithm gave a force that is not a number",
              kFades, "report it with the scene and the trace: it is an error in the program"},
    FaultText{ServoFault::kDeviceError, "device-error",
              "the device could not be read or written, or told a place that no motion explains",
              "falls to zero within the fade time while it lasts, then grows back within the fade time; while the "
              "device refuses writes it holds the force that it took last, and then falls at the slew limit",
              "check its cable and power, then start again"},
    FaultText{ServoFault::kForceLimited, "force-limited", "the force was larger than the device's maximum",
              "is cut to the maximum in the same direction, for as long as it would be larger",
              "lower the stiffness, or press less deep"},
    FaultText{ServoFault::kSlewLimited, "slew-limited", "the force changed faster than allowed",
              "follows at the slew limit until it has caught up",
              "lower the stiffness or n, or use a recovery time; a force that lags often shakes, so no limit far below "
              "stiffness times hand speed"},
    FaultText{ServoFault::kOverrun, "overrun", "a tick was not done when the next one was due",
              "is held by the device over the ticks left out, and goes on with the next one",
              "lower the rate, or give the servo a core and real-time priority"},
    FaultText{ServoFault::kZeroGradient, "zero-gradient", "the field is flat at the surface, so it gives no normal",
              "comes from the algorithm's best guess of the surface, or is none until it finds one",
              "smooth the volume, or choose an isovalue between two densities"},
    FaultText{ServoFault::kInsideObject, "inside-object", "the tool was inside the object without having entered it",
              "is none until the tool has been outside once", "move the tool out once; contact begins from outside"},
    FaultText{ServoFault::kSurfaceLost, "surface-lost",
              "the surface that was touched could not be found again, and the tool is inside the object", kFades,
              "move the tool out once; smooth a noisy volume, or press less deep"},
    FaultText{ServoFault::kStall, "stall", "the servo stood still, and the device held an old force meanwhile",
              "falls to zero at the slew limit, then grows back from nothing within the fade time",
              "give the servo a core and real-time priority"},
    FaultText{ServoFault::kDroppedReports, "dropped-reports", "the device gave no new position for too long", kFades,
              "check its cable and what else uses its bus, or allow an older position"},
    FaultText{ServoFault::kClockStep, "clock-step", "a clock went backwards or ahead, so the window's age is not known",
              kFades, "run the engine and the servo on the same monotonic clock"},
    FaultText{ServoFault::kPlaneBehind, "plane-behind",
              "the tool went farther along the surface in a tick than the surface was followed", kFades,
              "move more slowly, or raise the rate"},
    FaultText{
        ServoFault::kUnstable, "unstable",
        "the tool swung against the surface without settling, and the surface fed it",
        "falls to zero within the fade time, stays away until the tool has left the surface, and comes back with a "
        "quarter of the stiffness and damping",
        "lower the stiffness, the device's delay or the damping, raise the rate, or see the run's first lines for what "
        "this device can bear"},
    FaultText{
        ServoFault::kForceOff, "force-off",
        "the device exerted no force: it was not connected, not calibrated, without a limit, or its clutch was pressed",
        "is none while it lasts, then grows back from nothing within the fade time",
        "plug it in, calibrate it, or let the clutch go; 'palpate doctor' says which"},
    FaultText{ServoFault::kCalibrationRefused, "calibration-refused",
              "the device's calibration button was pressed in contact, while the handle moved, or away from home: "
              "refused",
              "stays as it is, and so does the calibration",
              "hold the handle still in its home position, touching nothing, and press it again"},
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
    if (has(faults, row.fault))
      lines += formatted("{}: {}; the force {}; {}\n", row.name, row.text, row.effect, row.remedy);
  }
  return lines;
}

std::string faultDocument() {
  std::string text = R"(# Faults

Every force leaves for the device through one gate, which keeps it finite, within the force limit and within the slew
limit, tick for tick, also during a fault: each force that the device takes differs from the one taken before by at most the
slew, however many it refused between them. The last force is never repeated while a fault lasts: it gets smaller in every
tick until it is zero. Where the slew limit does not allow the fade time, the fade takes as long as it must (force limit /
slew limit). The end of a run lets the force fade in the same way. `faults` in trace.csv is the sum of the values below. This page is printed by `palpate faults`.

| name | value | what happened | the force ... | what to do |
|---|---|---|---|---|
)";
  for (const FaultText& row : kTable) {
    text += formatted("| `{}` | {} | {} | {} | {} |\n", row.name, bit(row.fault), row.text, row.effect, row.remedy);
  }
  return text;
}

}  // namespace palpate
