// SPDX-License-Identifier: Apache-2.0
// tests/servo/support/algorithm_driver.hpp: moves a HIP through a volume, tick by tick, under a window that follows it.
#pragma once

#include <vector>

#include "servo/algorithms/algorithm.hpp"
#include "support/analytic_volume.hpp"

namespace palpate {

class AlgorithmDriver {
 public:
  AlgorithmDriver(Algorithm& algorithm, const AnalyticVolume& volume, const Vec3& start_W, int window_side = 32,
                  double rate_hz = 1000)
      : algorithm_(algorithm), volume_(&volume), side_(window_side), rate_hz_(rate_hz), last_W_(start_W) {
    algorithm_.reset(start_W);
    publish(start_W);
  }

  // One tick at `hip_W`; velocity is the backward difference.
  TickOutput at(const Vec3& hip_W) {
    const Vec3 focus_W = around_vhip && at_surface_ ? surface_W_ : hip_W;
    if (follow && (focus_W - centre_W_).cwiseAbs().maxCoeff() > 6 * volume_->lattice.smallestSpacing())
      publish(focus_W);
    TickOutput out;
    algorithm_.tick({hip_W, (hip_W - last_W_) * rate_hz_, &held_.window}, out);
    last_W_ = hip_W;
    at_surface_ = out.at_surface;
    surface_W_ = out.surface_W;
    return out;
  }

  // Straight from the last position to `to_W` in `ticks` ticks.
  std::vector<TickOutput> stroke(const Vec3& to_W, int ticks) {
    const Vec3 from_W = last_W_;
    std::vector<TickOutput> outs;
    for (int i = 1; i <= ticks; ++i) outs.push_back(at(from_W + (to_W - from_W) * (static_cast<double>(i) / ticks)));
    return outs;
  }

  // Another volume takes the place of the old one under the tool.
  void edit(const AnalyticVolume& volume) {
    volume_ = &volume;
    ++held_.window.edit_version;
    publish(centre_W_);
  }
  // One tick at a place that the last window does not hold, in which a window of a new edit of the same volume comes
  // around it.
  TickOutput leapWithEdit(const Vec3& to_W) {
    edit(*volume_);
    publish(to_W);
    follow = false;
    return at(to_W);
  }
  void publish(const Vec3& centre_W) {
    centre_W_ = centre_W;
    const Vec3i count = volume_->size.cwiseMin(side_);
    volume_->hold(held_, volume_->firstAround(centre_W, count), count, held_.window.version + 1);
  }

  SampleWindow& window() { return held_.window; }
  bool follow = true;
  bool around_vhip = false;  // in contact the window follows the surface point, as the engine places it

 private:
  Algorithm& algorithm_;
  const AnalyticVolume* volume_;
  int side_;
  double rate_hz_;
  Vec3 last_W_;
  Vec3 centre_W_ = Vec3::Zero();
  bool at_surface_ = false;
  Vec3 surface_W_ = Vec3::Zero();
  HeldWindow held_;
};

}  // namespace palpate
