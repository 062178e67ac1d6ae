// SPDX-License-Identifier: Apache-2.0
// tests/servo/loop/changing_press.hpp: a rigid hand on a ball, and a servo whose algorithm or force limit changes.
#pragma once

#include <functional>

#include "servo/loop/servo_changes.hpp"
#include "servo/loop/servo_loop.hpp"
#include "support/touch_scene.hpp"

namespace palpate {

inline constexpr std::int64_t kFalls = 100;  // ServoLoop::kChangeOver_s at 1 kHz [tick]
inline constexpr std::int64_t kGrows = 500;  // EditEase::kTime_s
inline const Vec3 kCentre = Vec3::Constant(31.3e-3);
inline constexpr double kRadius_m = 20e-3;

inline AlgorithmParameters stiff(double stiffness_N_per_m, int n = 5) {
  return {.stiffness_N_per_m = stiffness_N_per_m, .damping_Ns_per_m = 0, .plane_renewal_ticks = n};
}

// A rigid hand on a given path; changes can be given before any tick.
struct Press {
  TouchScene scene{1.0};
  std::unique_ptr<Algorithm> algorithm;
  ServoChanges changes;
  SampledPath path;
  SimulatedDeviceParameters device_parameters;
  LoopParameters parameters;

  Press(std::string_view name, const AlgorithmParameters& first, SampledPath way)
      : algorithm(makeFor(name, first, scene.volume, 4e-3)), path(std::move(way)) {
    parameters.ticks = std::llround(path.duration_s() * parameters.rate_hz);
  }

  [[nodiscard]] std::unique_ptr<Algorithm> make(std::string_view name, const AlgorithmParameters& p) const {
    return makeFor(name, p, scene.volume, 4e-3);
  }

  template <class BeforeTick>
  std::vector<TickRecord> run(const BeforeTick& before_tick) {
    SimulatedDevice device(device_parameters, path, parameters.rate_hz);
    ServoLoop loop(parameters, *algorithm, device, scene.windows, scene.tool);
    loop.takeChangesFrom(changes);
    return loop
        .runSimulated([&](std::int64_t tick, std::int64_t now_ns) {
          const ToolPose& pose = scene.tool.latest();
          if (tick % 16 == 0) scene.publish(pose.at_surface ? pose.surface_W : pose.position_W, now_ns);
          scene.windows.confirm(now_ns);
          before_tick(tick);
        })
        .records;
  }
};

// The windows of another engine over the same volume, in memory of its own, and the servo's ends of it.
struct NextEngine {
  NextEngine(const TouchScene& scene, std::uint64_t first_version)
      : volume(scene.volume),
        storage(scene.storage.capacity()),
        windows(block, storage.pointers(), storage.capacity(), first_version),
        servos_windows(block, storage.pointers(), storage.capacity()) {}
  // False: it has not heard of the tool.
  bool publish(std::int64_t now_ns) {
    const ToolPose& at = tool.latest();
    if (at.tick < 0) return false;
    const Vec3i count = Vec3i::Constant(32);
    volume.fill(windows.back(), windows.backSamples(),
                volume.firstAround(at.at_surface ? at.surface_W : at.position_W, count), count);
    windows.back().stamp_ns = now_ns;
    windows.publish();
    return true;
  }
  const AnalyticVolume& volume;
  WindowStorage storage;
  WindowBlock block;
  ToolPoseBlock pose;
  WindowExchange windows;
  ToolPoseMailbox tool{pose};
  WindowExchange servos_windows;
  ToolPoseMailbox servos_tool{pose};
};

inline Vec3 force(const TickRecord& r) {
  return asVec3(r.force_W);
}

inline Vec3 onBall(double angle, double depth_m) {
  return kCentre + (kRadius_m - depth_m) * Vec3(std::sin(angle), 0, std::cos(angle));
}

// From outside to `depth_m` within 0.1 s, and there it stays for a second.
inline SampledPath pressAndHold(double depth_m) {
  return {
      {0, 0.1, 1.1}, {onBall(0, -1e-3), onBall(0, depth_m), onBall(0, depth_m)}, SampledPath::Interpolation::kLinear};
}

}  // namespace palpate
