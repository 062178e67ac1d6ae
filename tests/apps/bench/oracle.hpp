// SPDX-License-Identifier: Apache-2.0
// An algorithm that knows the exact surface and makes errors of a given size, so that tests know what the bench must
// measure.
#pragma once

#include <functional>

#include "apps/bench/entrants.hpp"

namespace palpate {

struct OracleErrors {
  double lift_m = 0;       // of the VHIP over the surface [m]
  double force_share = 0;  // added to the force's magnitude [-]
  double turn_rad = 0;     // of the force, out of the normal [rad]
  // Whether the algorithm reports no contact in a tick.
  std::function<bool(int tick, double depth_m)> blind = [](int, double) { return false; };
};

class Oracle final : public Algorithm {
 public:
  Oracle(const Phantom& phantom, OracleErrors errors) : phantom_(phantom), errors_(std::move(errors)) {}
  void reset(const Vec3&) noexcept override { tick_ = 0; }
  void tick(const TickInput& in, TickOutput& out) noexcept override {
    out = TickOutput{};
    out.vhip_W = in.hip_W;
    const SurfaceOffset offset = phantom_.offset(in.hip_W);
    const double depth_m = -offset.distance_m;
    if (depth_m <= 0 || errors_.blind(tick_++, depth_m)) return;
    const Vec3 aside_W = offset.normal.unitOrthogonal();
    const double force_N = kBenchStiffness_N_per_m * depth_m * (1 + errors_.force_share);
    out.in_contact = true;
    out.normal_W = offset.normal;
    out.vhip_W = in.hip_W + (depth_m + errors_.lift_m) * offset.normal;
    out.force_W = force_N * (std::cos(errors_.turn_rad) * offset.normal + std::sin(errors_.turn_rad) * aside_W);
  }

 private:
  const Phantom& phantom_;
  OracleErrors errors_;
  int tick_ = 0;  // since the first one inside
};

inline std::vector<Entrant> oneEntrant(std::unique_ptr<Algorithm> algorithm) {
  std::vector<Entrant> entrants;
  entrants.push_back({"oracle", 1, "none", std::move(algorithm), {}});
  return entrants;
}

}  // namespace palpate
