// SPDX-License-Identifier: Apache-2.0
// apps/sampled/window_follower.hpp: windows of a SampledVolume that follow the tool as the engine's do. World frame W
// [m]. One thread.
#pragma once

#include <optional>
#include <vector>

#include "apps/sampled/sampled_volume.hpp"
#include "servo/algorithms/algorithm.hpp"

namespace palpate {

// When to gather a new window, by the engine's rule: stillServes() in engine/passes/window_pass.hpp.
class WindowRule {
 public:
  // The box to gather now; empty while the last window still serves.
  [[nodiscard]] std::optional<WindowBox> follow(const SampledVolume& volume, const Vec3& place_W);

 private:
  std::optional<WindowBox> last_;
};

// The place of the window for a tool at `hip_W` [m]: at the surface point of the last tick if the algorithm held one,
// otherwise at the tool. As engine/service/window_focus.hpp, but without its lead.
[[nodiscard]] inline const Vec3& windowPlace(const TickOutput& last, const Vec3& hip_W) noexcept {
  return last.at_surface ? last.surface_W : hip_W;
}

// One window that follows its place without delay. Each algorithm has its own, since each has its own place.
class WindowFollower {
 public:
  explicit WindowFollower(const SampledVolume& volume) : volume_(volume) {}
  WindowFollower(const WindowFollower&) = delete;
  WindowFollower& operator=(const WindowFollower&) = delete;
  WindowFollower(WindowFollower&&) = default;
  WindowFollower& operator=(WindowFollower&&) = delete;
  const SampleWindow& around(const Vec3& place_W);

 private:
  const SampledVolume& volume_;
  WindowRule rule_;
  std::vector<Sample> samples_;
  SampleWindow window_;
};

}  // namespace palpate
