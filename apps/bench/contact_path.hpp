// SPDX-License-Identifier: Apache-2.0
// apps/bench/contact_path.hpp: a tool that follows a phantom's exact surface, pressed below it by a fixed depth.
//
// Approach: the tool starts in free space two voxels in front of the surface and goes in along the normal until it is
// `depth_voxel` below. Slide: it then wanders over the level set at that depth. Each tick it takes one step of
// speed / rate along its heading; Newton's method on the exact signed distance brings it back onto the level set. The
// heading turns slowly, at random. A new heading is chosen where the next step would come nearer than kBorderVoxels to
// a face of the volume, or leave the level set (in a part thinner than twice the depth).
//
// World frame W [m]. The same seed gives the same path. Any thread. Cost: a few evaluations of the distance a tick.
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
  // 1 where depth and normal are exact: hip + depth * normal lies on the surface. Where two bodies meet, a phantom's
  // distance may be only a bound.
  std::vector<char> exact;
  std::size_t slide_begin = 0;  // first tick on the level set
  [[nodiscard]] std::size_t ticks() const noexcept { return hip_W.size(); }
};

inline constexpr double kBorderVoxels = 4;

// Throws Error(kBadInput) for a phantom on which no start is found.
[[nodiscard]] ContactPath contactPath(const Phantom& phantom, const ContactPathRequest& request);
[[nodiscard]] inline ContactPath contactPath(const BenchVolume& volume, const ContactPathRequest& request) {
  return contactPath(volume.phantom(), request);
}

}  // namespace palpate
