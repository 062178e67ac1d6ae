// SPDX-License-Identifier: Apache-2.0
// tests/servo/algorithms/ball_slide.hpp: a ball, places around it, and a tool that holds still while an edit is eased
// in.
#pragma once

#include <gtest/gtest.h>

#include "base/units.hpp"
#include "support/algorithm_driver.hpp"

namespace palpate {

inline constexpr double kVoxel = 1e-3;  // [m]
inline constexpr int kEaseTicks = 500;  // EditEase at 1 kHz
inline const Vec3 kCentre = Vec3::Constant(31.3e-3);
inline constexpr double kRadius = 24e-3;

inline double degreesBetween(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * kDegreesPerRadian;
}

inline AlgorithmParameters everyTick() {
  AlgorithmParameters p;
  p.plane_renewal_ticks = 1;
  return p;
}

// A slide over a quarter of the ball, 1 mm deep, at 0.2 m/s: angles in radians about a tilted axis.
inline Vec3 slidePoint(double angle, double radius_m) {
  const Vec3 u = Vec3(1, 0.3, 0.2).normalized();
  const Vec3 v = u.cross(Vec3(0.1, -0.4, 1)).normalized();
  return kCentre + (u * std::cos(angle) + v * std::sin(angle)) * radius_m;
}

// Holds the tool still until what an edit has added is taken in. The force must rise evenly from its old value.
inline TickOutput holdUntilEased(AlgorithmDriver& driver, const Vec3& hip_W, const TickOutput& first, double depth_m) {
  const double stiffness = AlgorithmParameters{}.stiffness_N_per_m;
  const double step_N = stiffness * depth_m / kEaseTicks;
  // Two planes of one surface, found for one HIP, agree to a hundredth of a voxel.
  const double rounding_N = stiffness * 0.01 * kVoxel;
  TickOutput before = first;
  TickOutput out = first;
  for (int i = 0; i < kEaseTicks; ++i) {
    out = driver.at(hip_W);
    EXPECT_LE((out.force_W - before.force_W).norm(), step_N + rounding_N);
    EXPECT_GE(out.force_W.norm(), before.force_W.norm() - rounding_N);
    before = out;
  }
  return out;
}

}  // namespace palpate
