// SPDX-License-Identifier: Apache-2.0
// apps/bench/contact_path.hpp: a tool that follows a phantom's exact surface, pressed below it by a fixed depth.
//
// It begins in free space two voxels in front of the surface, goes straight in along the normal until it is
// `depth_voxel` below, and then wanders over the level set at that depth: each tick one step of speed / rate along the
// heading, then back onto the level set by Newton's method on the exact signed distance. The heading turns slowly by
// chance, and anew where the path would come nearer than kBorderVoxels to a face of the volume, or where the level set
// ends (a part thinner than twice the depth). Frame W [m]. The same seed gives the same path. Cost: some distances a
// tick. Any thread.
#pragma once

#include <cstdint>
#include <vector>

#include "apps/bench/bench_volume.hpp"

namespace palpate {

struct ContactPathRequest {
  double speed_m_per_s = 0.1;
  double rate_hz = 1000;
  double depth_voxel = 1;  // in smallest voxels
  std::size_t ticks = 1000;
  std::uint64_t seed = 1;
};

struct ContactPath {
  std::vector<Vec3> hip_W;       // [m]
  std::vector<Vec3> velocity_W;  // backward difference [m/s]
  std::vector<Vec3> normal_W;    // exact, at the surface point nearest to the HIP [-]
  std::vector<double> depth_m;   // of the HIP below the exact surface; negative outside [m]
  // Whether depth and normal are exact there: where two bodies meet, a phantom's distance may be a bound only. Tried by
  // looking whether hip + depth * normal lies on the surface.
  std::vector<char> exact;
  std::size_t slide_begin = 0;  // first tick on the level set
  [[nodiscard]] std::size_t ticks() const noexcept { return hip_W.size(); }
};

inline constexpr double kBorderVoxels = 4;

// Throws Error(kBadInput) for a phantom on which no start is found.
[[nodiscard]] ContactPath contactPath(const BenchVolume& volume, const ContactPathRequest& request);

}  // namespace palpate
