// SPDX-License-Identifier: Apache-2.0
// servo/devices/calibration_refusal.hpp: why a device does not take its handle's place for its home position, in words.
// Any thread; no heap.
#pragma once

#include <array>
#include <string_view>

#include "servo/devices/device.hpp"

namespace palpate {

struct CalibrationRefusalWords {
  std::string_view figure;  // how often it was refused: a key of Device::figures()
  std::string_view reason;  // "it pushes the hand"
  std::string_view remedy;  // what to do
};

inline constexpr std::array kCalibrationRefusals = {CalibrationRefusal::kContact, CalibrationRefusal::kMoving,
                                                    CalibrationRefusal::kAway};

[[nodiscard]] constexpr CalibrationRefusalWords wordsOf(CalibrationRefusal why) noexcept {
  switch (why) {
    case CalibrationRefusal::kNone:
      return {"", "", ""};
    case CalibrationRefusal::kContact:
      return {"calibrations_refused_in_contact", "the arm pushed the hand",
              "leave what it touches, hold the handle in its home position, and try again"};
    case CalibrationRefusal::kMoving:
      return {"calibrations_refused_moving", "the handle moved", "hold it still in its home position, and try again"};
    case CalibrationRefusal::kAway:
      return {"calibrations_refused_away", "the arm is calibrated, and its handle was not in its home position",
              "put it there, and try again; if it was there, unplug the arm, plug it in and calibrate it anew"};
  }
  return {"", "", ""};
}

}  // namespace palpate
