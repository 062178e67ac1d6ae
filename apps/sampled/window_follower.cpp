// SPDX-License-Identifier: Apache-2.0
#include "apps/sampled/window_follower.hpp"

namespace palpate {

std::optional<WindowBox> WindowRule::follow(const SampledVolume& volume, const Vec3& place_W) {
  const WindowBox box = windowAround(volume.lattice().toIndex(place_W), volume.size());
  if (last_ && stillServes(*last_, box, volume.size())) return std::nullopt;
  last_ = box;
  return box;
}

const SampleWindow& WindowFollower::around(const Vec3& place_W) {
  if (const auto box = rule_.follow(volume_, place_W)) volume_.gather(*box, samples_, window_);
  return window_;
}

}  // namespace palpate
