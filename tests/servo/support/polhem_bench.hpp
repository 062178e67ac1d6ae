// SPDX-License-Identifier: Apache-2.0
// tests/servo/support/polhem_bench.hpp: a Polhem's host side on an emulated cable, by the simulated clock.
#pragma once

#include <cmath>
#include <string_view>

#include <gtest/gtest.h>

#include "support/emulated_polhem.hpp"

namespace palpate {

inline constexpr double kPolhemTick_s = 1e-3;

inline PolhemParameters knownPolhem() {
  PolhemParameters p;
  p.current_limit_A = 3;
  return p;
}

// From 2 cm above to 1 cm below the middle of the workspace, then sideways.
inline const SampledPath& pressed() {
  static const SampledPath path({0, 1, 2, 3},
                                {Vec3(0, 0.02, 0), Vec3(0, -0.01, 0), Vec3(0.03, -0.01, 0.02), Vec3(0, 0.02, 0)},
                                SampledPath::Interpolation::kCubic);
  return path;
}
inline const SampledPath& resting() {
  static const SampledPath path({0}, {Vec3(0.01, 0.02, -0.01)}, SampledPath::Interpolation::kLinear);
  return path;
}

// A device on an emulated cable.
struct PolhemBench {
  explicit PolhemBench(const Path& path, const PolhemParameters& p = knownPolhem(), bool calibrated = true,
                       const HandParameters& hand = {})
      : emulated(p, hand, path, kPolhemTick_s, calibrated),
        cable(emulated),
        device(p,
               {.simulated_clock = true,
                .rate_hz = 1 / kPolhemTick_s,
                .calibrated = calibrated,
                .motors_checked = true,
                .answer_ms = 0},
               cable.opener()) {}

  Vec3 position() {
    Vec3 p = Vec3::Constant(std::nan(""));
    EXPECT_TRUE(device.read(p));
    return p;
  }
  double figure(std::string_view key) const {
    for (const DeviceFigure& f : device.figures()) {
      if (f.key == key) return f.value;
    }
    ADD_FAILURE() << "no figure " << key;
    return -1;
  }
  // Ticks with the same force.
  void pass(int ticks, const Vec3& force = Vec3::Zero()) {
    Vec3 ignored;
    for (int i = 0; i < ticks; ++i) {
      static_cast<void>(device.write(force));
      device.elapse(1);
      static_cast<void>(device.read(ignored));
    }
  }

  EmulatedPolhem emulated;
  EmulatedCable cable;
  PolhemDevice device;
};

}  // namespace palpate
