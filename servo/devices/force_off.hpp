// SPDX-License-Identifier: Apache-2.0
// servo/devices/force_off.hpp: why a device exerts no force, in words for its user. Any thread; no heap.
#pragma once

#include <string_view>

#include "servo/devices/device.hpp"

namespace palpate {

struct ForceOffWords {
  std::string_view name;    // "uncalibrated": for programs
  std::string_view reason;  // ends "forces are off because ..."
  std::string_view remedy;  // what to do
};

[[nodiscard]] constexpr ForceOffWords wordsOf(ForceOff why) noexcept {
  switch (why) {
    case ForceOff::kNone:
      return {"none", "", ""};
    case ForceOff::kInputOnly:
      return {"input-only", "the device has no motors", "choose a device with forces"};
    case ForceOff::kNoCurrentLimit:
      return {"no-current-limit", "nobody said what current the device's firmware is made for",
              "read it off the amplifiers and give it with --current-limit"};
    case ForceOff::kUncalibrated:
      return {"uncalibrated", "the device does not know where its handle is",
              "put the handle into its home position and press the calibration button, or run 'palpate calibrate'"};
    case ForceOff::kLimitZero:
      return {"limit-zero", "the force limit is 0", "raise force_limit_N in the table of its kind (docs/devices.md)"};
    case ForceOff::kDisconnected:
      return {"disconnected", "the device is not connected", "plug it in; it is found again by itself"};
    case ForceOff::kClutched:
      return {"clutched", "the switch of its handle is pressed", "let it go"};
  }
  return {"?", "", ""};
}

}  // namespace palpate
