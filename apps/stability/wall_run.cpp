// SPDX-License-Identifier: Apache-2.0
#include "apps/stability/wall_run.hpp"

#include <cmath>
#include <utility>

namespace palpate {
namespace {

class HandPath final : public Path {
 public:
  HandPath(const std::function<Vec3(double)>& at_W, double seconds) : at_W_(at_W), seconds_(seconds) {}
  [[nodiscard]] Vec3 position(double time_s) const noexcept override { return at_W_(time_s); }
  [[nodiscard]] double duration_s() const noexcept override { return seconds_; }

 private:
  const std::function<Vec3(double)>& at_W_;
  double seconds_;
};

std::unique_ptr<Algorithm> algorithmFor(const WallContact& contact, const WallVolume& volume, double rate_hz) {
  AlgorithmSetup setup;
  setup.parameters = {.isovalue = WallVolume::kIsovalue,
                      .stiffness_N_per_m = contact.wall.stiffness_N_per_m,
                      .damping_Ns_per_m = contact.wall.damping_Ns_per_m,
                      .plane_renewal_ticks = contact.n,
                      .rate_hz = rate_hz};
  setup.effects = makeContactEffects(contact.effects, contact.wall.stiffness_N_per_m, rate_hz);
  setup.scale = volume.scale();
  setup.isosurface = volume.isosurface();
  return makeAlgorithm(contact.algorithm, std::move(setup));
}

}  // namespace

SimulatedDeviceParameters heldDevice(const HandParameters& hand) {
  SimulatedDeviceParameters device;
  device.hand = Hand::kSpring;
  device.dynamics = hand;
  device.force_limit_N = 1e9;
  return device;
}

LoopParameters limitlessLoop(double rate_hz) {
  LoopParameters loop;
  loop.rate_hz = rate_hz;
  loop.safety.force_limit_N = 1e9;
  loop.safety.slew_limit_N_per_s = 1e13;
  loop.safety.stale_window_s = 1e6;
  loop.instability.act = false;
  return loop;
}

std::vector<TickRecord> play(const WallRun& run, const WallVolume& volume) {
  const double rate_hz = run.loop.rate_hz;
  const HandPath path(run.hand_W, run.seconds);
  SimulatedDevice device(run.device, path, rate_hz);
  const std::unique_ptr<Algorithm> algorithm = algorithmFor(run.contact, volume, rate_hz);
  WindowStorage storage(static_cast<std::size_t>(WallVolume::kSide) * WallVolume::kSide * WallVolume::kSide);
  WindowExchange windows(storage);
  volume.publish(windows);
  ToolPoseMailbox tool;
  ServoChanges changes;
  LoopParameters parameters = run.loop;
  parameters.ticks = std::llround(run.seconds * rate_hz);
  ServoLoop loop(parameters, *algorithm, device, windows, tool);
  loop.takeChangesFrom(changes);
  auto next = run.changes.begin();
  LoopResult result = loop.runSimulated([&](std::int64_t tick, std::int64_t) {
    if (next == run.changes.end() || static_cast<double>(tick) < next->time_s * rate_hz) return;
    changes.give({.algorithm = algorithmFor(next->contact, volume, rate_hz)});
    ++next;
  });
  return std::move(result.records);
}

}  // namespace palpate
