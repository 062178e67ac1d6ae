// SPDX-License-Identifier: Apache-2.0
// servo/devices/sampled_path.hpp: a path through time-stamped points.
//
// kLinear: straight between the points. kCubic: cubic Hermite with the tangents of Catmull and Rom for uneven times
// (that of the parabola through three neighbours). So the velocity is continuous, and between inner points a parabola
// is met exactly. Frame W: world [m]; times [s]. Thread: const after construction. Cost: a binary search and some 30
// multiplications.
#pragma once

#include <vector>

#include "servo/devices/path.hpp"

namespace palpate {

class SampledPath final : public Path {
 public:
  enum class Interpolation { kLinear, kCubic };

  // Throws Error(kBadInput) without points, if there are not as many times as points, on a value that is not finite,
  // and unless each time is later than the one before. The first time may be any; it becomes 0 of the path's own time.
  SampledPath(std::vector<double> times_s, std::vector<Vec3> points_W, Interpolation interpolation);

  [[nodiscard]] Vec3 position(double time_s) const noexcept override;
  [[nodiscard]] double duration_s() const noexcept override { return times_s_.back(); }

 private:
  [[nodiscard]] Vec3 tangent(std::size_t i) const noexcept;  // [m/s]

  std::vector<double> times_s_;
  std::vector<Vec3> points_W_;
  std::vector<Vec3> tangents_W_;  // empty for kLinear [m/s]
};

}  // namespace palpate
