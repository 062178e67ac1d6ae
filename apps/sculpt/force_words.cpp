// SPDX-License-Identifier: Apache-2.0
#include "apps/sculpt/force_words.hpp"

#include <cmath>

#include <fmt/format.h>

#include "base/units.hpp"
#include "servo/devices/force_off.hpp"
#include "servo/safety/faults.hpp"

namespace palpate {

ForceWords forceWords(const TickRecord& tick, const std::string& missing, double isovalue,
                      std::optional<ForceOff> held) {
  ForceWords words;
  if (!missing.empty()) {
    words.state = "the servo is not running";
    words.reasons.push_back(missing);
    return words;
  }
  if (tick.tick < 0) {
    words.state = "the servo is starting";
    return words;
  }
  const double force_N = asVec3(tick.force_W).norm();
  words.state = tick.in_contact ? fmt::format("{:.2f} N, {:.2f} mm deep", force_N, tick.depth_m * kMillimetresPerMetre)
                                : "no contact";
  if (held && *held != ForceOff::kNone) {
    const ForceOffWords off = wordsOf(*held);
    words.reasons.push_back(fmt::format("forces are off because {}: {}", off.reason, off.remedy));
  }
  for (const FaultText& fault : faultTable()) {
    if (has(tick.faults, fault.fault)) words.reasons.push_back(fmt::format("{}: {}", fault.text, fault.remedy));
  }
  if (tick.in_contact || !words.reasons.empty()) return words;
  if (!std::isfinite(tick.density)) {
    words.reasons.emplace_back("the tool is outside the volume: move it to the object");
  } else if (tick.density <= isovalue) {
    words.reasons.push_back(
        fmt::format("the tool is outside the object (density {:.4g} there, the surface is at {:.4g}): "
                    "{}",
                    tick.density, isovalue, held ? "move the device to it" : "press the left button on the object"));
  } else {
    words.reasons.emplace_back("the tool was inside the object before it touched its surface: take it out once");
  }
  return words;
}

}  // namespace palpate
