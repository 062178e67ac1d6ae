// SPDX-License-Identifier: Apache-2.0
// apps/bench/press_rows.hpp: every algorithm pressed deep, into noise, and drawn fast over curved surfaces.
//
// Rows of part "press", one for each volume, noise, depth, algorithm and n: the errors of touch_errors.hpp along
// contact_path.hpp's path at 0.1 m/s. Noise is in the samples only; path, depth and normal are the exact surface's. Its
// standard deviation is told as how far it moves the surface [voxel]. Over several seeds, of noise and path, medians
// are the median seed's, other figures the worst seed's, counts sums.
// Rows of part "speed", one for each volume, speed, algorithm and n: the same without noise.
// Windows follow as in the program (windowPlace), without delay. Frame W. Thread: the caller's.
#pragma once

#include <string>
#include <vector>

#include "apps/bench/bench_result.hpp"
#include "apps/bench/touch_errors.hpp"

namespace palpate {

inline constexpr const char* kBall20mm = "phantom:sphere?size=115&spacing=0.5mm";  // radius 19.95 mm, voxels of 0.5 mm
inline constexpr const char* kTubeOf8 = "phantom:knot?size=128x128x64";            // a tube of 8.3 voxels of 1 mm

struct PressRequest {
  std::string volume;
  std::vector<double> depths_voxel;
  std::vector<double> noises_voxel = {0, 0.1, 0.25, 0.5};
  std::vector<int> renewals = {1, 5};
  std::size_t ticks = 5000;
  std::uint64_t first_seed = 1;
  int seeds = 5;  // one without noise
};
void addPressRows(const PressRequest& request, BenchResult& result, const BenchProgress& progress);

struct SpeedRequest {
  std::string volume;
  double depth_voxel = 1;
  std::vector<double> speeds_m_per_s;
  std::vector<int> renewals = {1, 2, 5, 10, 20, 50, 100, 1000};
  std::size_t ticks = 5000;
  std::uint64_t seed = 1;
};
void addSpeedRows(const SpeedRequest& request, BenchResult& result, const BenchProgress& progress);

}  // namespace palpate
