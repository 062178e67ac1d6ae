// SPDX-License-Identifier: Apache-2.0
// apps/sculpt/touch_sliders.hpp: the settings of the touch that a person moves in the window, each by itself. What it
// is and means is in the option table. Any thread; no cost.
#pragma once

#include <span>

#include "apps/scene/option_table.hpp"
#include "apps/servo_setup/rig_settings.hpp"

namespace palpate {

struct TouchSlider {
  const char* label;
  const char* key;              // of its option
  double& (*of)(RigSettings&);  // in SI units
  double low, high;             // the part of the option's range that a hand may want; SI units
  double unit;                  // that is shown, in SI units
  const char* form;             // of the number
  bool logarithmic = false;
  double& (*floor)(RigSettings&) = nullptr;    // another setting that this one may not fall below
  double& (*ceiling)(RigSettings&) = nullptr;  // or rise above

  // The range now.
  [[nodiscard]] double lowest(RigSettings settings) const { return floor != nullptr ? floor(settings) : low; }
  [[nodiscard]] double highest(RigSettings settings) const { return ceiling != nullptr ? ceiling(settings) : high; }
};

[[nodiscard]] std::span<const TouchSlider> touchSliders();

inline constexpr int kMostRenewal_ticks = 100;  // of the window's slider

}  // namespace palpate
