// SPDX-License-Identifier: Apache-2.0
// The servo by itself: a tool presses a ball and slides over it. Prints what it feels, and fails if that is not the
// ball.
//
// Whoever has a volume does three things: publish a window of samples around the tool (here one that holds the whole
// ball, so once), confirm that it still holds, and give the loop an algorithm and a device.
#include <cmath>
#include <cstdio>

#include "servo/algorithms/registry.hpp"
#include "servo/devices/simulated_device.hpp"
#include "servo/loop/servo_loop.hpp"

namespace {

using namespace palpate;

constexpr double kRadius_m = 20e-3, kVoxel_m = 1e-3, kDepth_m = 1e-3;
constexpr int kEdge = 48;  // samples along each axis

// Density above 0 is object: the distance below the surface [m]. The gradient of that is -p / |p|.
void publishBall(WindowExchange& windows) {
  SampleWindow& window = windows.back();
  window.lattice.origin_W = Vec3::Constant(-kVoxel_m * (kEdge - 1) / 2);
  window.lattice.spacing_m = Vec3::Constant(kVoxel_m);
  window.size = Vec3i::Constant(kEdge);
  window.low_is_border = window.high_is_border = {true, true, true};
  Sample* out = windows.backSamples();
  for (int k = 0; k < kEdge; ++k) {
    for (int j = 0; j < kEdge; ++j) {
      for (int i = 0; i < kEdge; ++i) {
        const Vec3 p_W = window.lattice.toWorld(Vec3(i, j, k));
        const Eigen::Vector3f gradient = (-p_W / p_W.norm()).cast<float>();
        *out++ = {gradient.x(), gradient.y(), gradient.z(), static_cast<float>(kRadius_m - p_W.norm())};
      }
    }
  }
  windows.publish();
}

// From above to a depth of 1 mm in 0.2 s, then a quarter of a radian over the ball in 0.2 s.
SampledPath pathOfTool() {
  std::vector<double> times_s;
  std::vector<Vec3> points_W;
  for (int n = 0; n <= 40; ++n) {
    const double depth_m = std::min(n, 20) * 2 * kDepth_m / 20 - kDepth_m, angle = 0.25 * std::max(n - 20, 0) / 20;
    times_s.push_back(0.01 * n);
    points_W.push_back((kRadius_m - depth_m) * Vec3(std::sin(angle), 0, std::cos(angle)));
  }
  return {times_s, points_W, SampledPath::Interpolation::kCubic};
}

// Trilinear interpolation of a distance is off by at most h^2 / 8 times its second derivatives, 2 / R. A plane that is
// n T = 5 ms old is off by (v n T)^2 / 2 R, for v = 25 mm/s. Together 13 um; the rest is for float and rounding.
constexpr double kBound_m = 15e-6;

}  // namespace

int main() {
  WindowStorage storage(kEdge * kEdge * kEdge);
  WindowExchange windows(storage);
  publishBall(windows);

  AlgorithmSetup setup;
  setup.parameters = {.isovalue = 0, .stiffness_N_per_m = 500, .damping_Ns_per_m = 0};
  const std::unique_ptr<Algorithm> algorithm = makeAlgorithm("hri", std::move(setup));
  const SampledPath path = pathOfTool();
  LoopParameters loop;
  loop.ticks = 400;
  SimulatedDevice device({}, path, loop.rate_hz);
  ToolPoseMailbox tool;
  const LoopResult run =
      ServoLoop(loop, *algorithm, device, windows, tool).runSimulated([&](auto, std::int64_t now_ns) {
        windows.confirm(now_ns);
      });

  int in_contact = 0;
  double worst_m = 0;
  for (const TickRecord& tick : run.records) {
    const Vec3 vhip_W(tick.vhip_W[0], tick.vhip_W[1], tick.vhip_W[2]);
    const Vec3 force_W(tick.force_W[0], tick.force_W[1], tick.force_W[2]);
    if (tick.tick % 50 == 0)
      std::printf("%5.3f s  depth %6.3f mm  force %6.3f N\n", tick.time_s, 1e3 * tick.depth_m, force_W.norm());
    if (!tick.in_contact) continue;
    ++in_contact;
    worst_m = std::max(worst_m, std::abs(vhip_W.norm() - kRadius_m));
  }
  std::printf("%d ticks in contact; the surface point is off by %.1f um at most\n", in_contact, 1e6 * worst_m);
  return in_contact > 250 && worst_m <= kBound_m ? 0 : 1;
}
