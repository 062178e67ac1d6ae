// SPDX-License-Identifier: Apache-2.0
// servo/devices/path.hpp: where a hand wants to be, over time; and a path through time-stamped points.
//
// Frame W: world [m]; time since the start [s]. Thread: const, so any. position() allocates nothing and has no errors.
// Before 0 and after the end the path rests at its ends.
#pragma once

#include <cstdint>
#include <vector>

#include "base/vec.hpp"

namespace palpate {

class Path {
 public:
  virtual ~Path() = default;
  [[nodiscard]] virtual Vec3 position(double time_s) const noexcept = 0;  // [m]
  [[nodiscard]] virtual double duration_s() const noexcept = 0;           // [s]
  // How often it has gone on elsewhere, up to the last position(): nothing lies between the places before and after.
  [[nodiscard]] virtual std::uint64_t leaps() const noexcept { return 0; }
};

// kLinear: straight lines between the points. kCubic: cubic Hermite. The tangent at a point is that of the parabola
// through it and its two neighbours (Catmull and Rom, for uneven times). So the velocity is continuous, and between
// inner points a parabola is reproduced exactly. Cost: a binary search and some 30 multiplications.
class SampledPath final : public Path {
 public:
  enum class Interpolation { kLinear, kCubic };

  // Throws Error(kBadInput) without points, if there are not as many times as points, on a value that is not finite,
  // and unless each time is later than the one before. The first time may be any; it becomes 0 of the path's own time.
  SampledPath(std::vector<double> times_s, std::vector<Vec3> points_W, Interpolation interpolation);

  [[nodiscard]] Vec3 position(double time_s) const noexcept override;
  [[nodiscard]] double duration_s() const noexcept override { return times_s_.back(); }

  // What it was made of, from time 0 on: another path of these is the same, to the bit.
  [[nodiscard]] const std::vector<double>& times_s() const noexcept { return times_s_; }
  [[nodiscard]] const std::vector<Vec3>& points_W() const noexcept { return points_W_; }
  [[nodiscard]] Interpolation interpolation() const noexcept {
    return tangents_W_.empty() ? Interpolation::kLinear : Interpolation::kCubic;
  }

 private:
  [[nodiscard]] Vec3 tangent(std::size_t i) const noexcept;  // [m/s]

  std::vector<double> times_s_;
  std::vector<Vec3> points_W_;
  std::vector<Vec3> tangents_W_;  // empty for kLinear [m/s]
};

}  // namespace palpate
