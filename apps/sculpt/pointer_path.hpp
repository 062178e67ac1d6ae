// SPDX-License-Identifier: Apache-2.0
// apps/sculpt/pointer_path.hpp: leads the simulated device where a mouse points.
//
// A pointer jumps from one place to another some sixty times a second. A hand does not: it follows as a critically
// damped spring, and at most at kFastest_m_per_s, so that the servo meets no step.
//
// Frame W: world [m]. Threads: aim() by one thread, position() by the device's, with times that do not decrease. No
// lock, no heap. The solution between two aims is exact, whatever the rate of the servo.
#pragma once

#include <limits>

#include "servo/devices/path.hpp"
#include "servo/window/triple_buffer.hpp"

namespace palpate {

class PointerPath final : public Path {
 public:
  static constexpr double kTimeConstant_s = 0.02;  // of the spring: a jump is half made after 1.7 of them
  static constexpr double kFastest_m_per_s = 0.5;

  explicit PointerPath(const Vec3& start_W) : aim_(start_W), position_W_(start_W) {}

  void aim(const Vec3& p_W) noexcept {
    aim_.back() = p_W;
    aim_.publish();
  }

  [[nodiscard]] Vec3 position(double time_s) const noexcept override;
  [[nodiscard]] double duration_s() const noexcept override { return std::numeric_limits<double>::infinity(); }

 private:
  // The device's state. Its functions are const because paths of other kinds have none.
  mutable TripleBuffer<Vec3> aim_;
  mutable double time_s_ = 0;
  mutable Vec3 position_W_;
  mutable Vec3 velocity_W_ = Vec3::Zero();
};

}  // namespace palpate
