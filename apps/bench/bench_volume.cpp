// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/bench_volume.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace palpate {

double borderDistance(const Phantom& phantom, const Vec3& p_W) {
  const Vec3 p_L = phantom.lattice().toIndex(p_W);
  const Vec3 last_L = (phantom.size() - Vec3i::Ones()).cast<double>();
  return std::min(p_L.minCoeff(), (last_L - p_L).minCoeff());
}

BenchVolume::BenchVolume(const std::string& name) : BenchVolume(name, makePhantom(name)) {}

BenchVolume::BenchVolume(const std::string& name, std::unique_ptr<Phantom> phantom)
    : SampledVolume(makeVolume(*phantom), phantom->isovalue()), name_(name), phantom_(std::move(phantom)) {}

BenchVolume::BenchVolume(std::unique_ptr<Phantom> phantom, Volume samples, double isovalue,
                         const GradientOperator& gradient_operator)
    : SampledVolume(std::move(samples), isovalue, gradient_operator),
      name_(phantom->spec().text),
      phantom_(std::move(phantom)) {}

std::string withNoise(const std::string& phantom, double noise_voxel, std::uint64_t seed) {
  if (noise_voxel == 0) return phantom;
  const std::unique_ptr<Phantom> exact = makePhantom(phantom);
  const Phantom::Profile& profile = exact->profile();
  const double deviation = noise_voxel * exact->lattice().smallestSpacing() * profile.slope_per_m;
  return fmt::format("{}{}noise={}&seed={}", phantom, phantom.find('?') == std::string::npos ? '?' : '&',
                     deviation / (profile.high - profile.low), seed);
}

}  // namespace palpate
