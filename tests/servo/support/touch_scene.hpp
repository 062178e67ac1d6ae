// SPDX-License-Identifier: Apache-2.0
// tests/servo/support/touch_scene.hpp: everything that a loop needs to press on a ball: volume, window, path,
// algorithm.
#pragma once

#include "servo/devices/path.hpp"
#include "servo/devices/simulated_device.hpp"
#include "servo/loop/servo_loop.hpp"
#include "support/algorithm_setups.hpp"

namespace palpate {

class TouchScene {
 public:
  explicit TouchScene(double duration_s = 0.2, std::string_view algorithm_name = "hri")
      : volume(millimetreVolume(ball(Vec3::Constant(31.3e-3), 20e-3))),
        path({0, 0.5 * duration_s, duration_s}, {above(1e-3), above(-1.5e-3), above(-0.5e-3)},
             SampledPath::Interpolation::kCubic),
        storage(std::size_t{32} * 32 * 32),
        windows(storage),
        algorithm(makeFor(algorithm_name, {}, volume, 4e-3)) {}

  // A place over the ball's pole. The deeper, the farther aside, so that the tool slides too.
  static Vec3 above(double height_m) { return Vec3::Constant(31.3e-3) + Vec3(-height_m, 0, 20e-3 + height_m); }

  void publish(const Vec3& around_W, std::int64_t now_ns) {
    const Vec3i count = Vec3i::Constant(32);
    volume.fill(windows.back(), windows.backSamples(), volume.firstAround(around_W, count), count);
    windows.back().stamp_ns = now_ns;
    windows.publish();
  }

  AnalyticVolume volume;
  SampledPath path;
  WindowStorage storage;
  WindowExchange windows;
  ToolPoseMailbox tool;
  std::unique_ptr<Algorithm> algorithm;
};

}  // namespace palpate
