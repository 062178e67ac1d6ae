// SPDX-License-Identifier: Apache-2.0
#include "apps/held/held_words.hpp"

#include <cmath>

#include <fmt/format.h>

#include "servo/devices/force_off.hpp"

namespace palpate {
namespace {

// In four digits, and not more than it is: whoever obeys must not be told the same again.
double roundedDown(double value) {
  const double step = std::pow(10.0, std::floor(std::log10(value)) - 3);
  return std::floor(value / step) * step;
}

}  // namespace

UncheckedWords uncheckedWords(const std::string& kind) {
  return {.reason = fmt::format("nobody has checked that its motors pull the right way, so forces stay below {:g} N, "
                                "whatever arm it is",
                                kUncheckedForce_N),
          .remedy = fmt::format("run 'palpate calibrate --device {} --check'", kind)};
}

std::vector<std::string> heldDeviceWords(const std::string& name, const Device& device, const Placement& placement,
                                         double stiffness_N_per_m) {
  std::vector<std::string> words;
  words.push_back(
      fmt::format("{}: 1 mm of the device moves the tool by {:.4g} mm, 1 N of the scene is {:.4g} N; a wall of {:.4g} "
                  "N/m is one of {:.4g} N/m at its handle",
                  name, placement.scale, placement.force_scale, stiffness_N_per_m,
                  stiffness_N_per_m * placement.scale * placement.force_scale));
  if (const ForceOff why = device.forceOff(); why != ForceOff::kNone) {
    const ForceOffWords off = wordsOf(why);
    words.push_back(fmt::format("forces are off because {}; {}", off.reason, off.remedy));
  }
  if (device.limits().motors_unchecked) {
    const UncheckedWords unchecked = uncheckedWords(name);
    words.push_back(fmt::format("{}; {}", unchecked.reason, unchecked.remedy));
  }
  const double most = device.limits().stiffness_limit_N_per_m;
  if (most > 0 && stiffness_N_per_m > most) {
    words.push_back(
        fmt::format("a stiffness of {:.4g} N/m is more than the device's maker states: give at most {:.4g} N/m",
                    stiffness_N_per_m, roundedDown(most)));
  }
  return words;
}

}  // namespace palpate
