// SPDX-License-Identifier: Apache-2.0
#include "apps/sampled/window_follower.hpp"

namespace palpate {
namespace {

constexpr int kRecentreVoxels = 6;  // as in engine/service/engine.cpp

}  // namespace

std::optional<WindowBox> WindowRule::follow(const SampledVolume& volume, const Vec3& place_W) {
  const WindowBox box = windowAround(volume.lattice().toIndex(place_W), volume.size());
  if (last_) {
    const Vec3i last = volume.size() - box.size;
    const auto stopped = [&](int axis) {
      const int first = box.first[axis];
      return first != last_->first[axis] && (first == 0 || first == last[axis]);
    };
    const bool near = (box.first - last_->first).cwiseAbs().maxCoeff() < kRecentreVoxels;
    if (near && !stopped(0) && !stopped(1) && !stopped(2)) return std::nullopt;
  }
  last_ = box;
  return box;
}

const SampleWindow& WindowFollower::around(const Vec3& place_W) {
  if (const auto box = rule_.follow(volume_, place_W)) volume_.gather(*box, samples_, window_);
  return window_;
}

}  // namespace palpate
