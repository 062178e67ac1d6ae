// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/bench_volume.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "engine/field/isosurface_mesh.hpp"
#include "engine/reference/window.hpp"

namespace palpate {
namespace {

constexpr int kRecentreVoxels = 6;  // as in engine/service/engine.cpp

}  // namespace

double borderDistance(const Phantom& phantom, const Vec3& p_W) {
  const Vec3 p_L = phantom.lattice().toIndex(p_W);
  const Vec3 last_L = (phantom.size() - Vec3i::Ones()).cast<double>();
  return std::min(p_L.minCoeff(), (last_L - p_L).minCoeff());
}

BenchVolume::BenchVolume(const std::string& name)
    : name_(name), phantom_(makePhantom(name)), isovalue_(static_cast<float>(phantom_->isovalue())) {
  const Volume volume = makeVolume(*phantom_);
  maximum_ = volume.maximum();
  isosurface_ = isosurfaceMesh(volume, isovalue_);
  samples_ = reference::windowSamples(reference::denseField(volume), Vec3i::Zero(), volume.size());
}

void BenchVolume::gather(const WindowBox& box, std::vector<Sample>& samples, SampleWindow& window) const {
  samples.resize(static_cast<std::size_t>(box.size.prod()));
  auto to = samples.begin();
  for (int k = 0; k < box.size.z(); ++k) {
    for (int j = 0; j < box.size.y(); ++j) {
      const auto row = (static_cast<std::ptrdiff_t>(box.first.z() + k) * size().y() + box.first.y() + j) * size().x();
      to = std::copy_n(samples_.begin() + row + box.first.x(), box.size.x(), to);
    }
  }
  window.lattice = phantom_->lattice().shifted(box.first);
  window.size = box.size;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    window.low_is_border[a] = box.first[axis] == 0;
    window.high_is_border[a] = box.first[axis] + box.size[axis] == size()[axis];
  }
  ++window.version;
  window.samples = samples.data();
}

SampleWindow BenchVolume::whole() const {
  SampleWindow window;
  window.lattice = phantom_->lattice();
  window.size = size();
  window.low_is_border = window.high_is_border = {true, true, true};
  window.version = 1;
  window.samples = samples_.data();
  return window;
}

std::string withNoise(const std::string& phantom, double noise_voxel, std::uint64_t seed) {
  if (noise_voxel == 0) return phantom;
  const std::unique_ptr<Phantom> exact = makePhantom(phantom);
  const Phantom::Profile& profile = exact->profile();
  const double deviation = noise_voxel * exact->lattice().smallestSpacing() * profile.slope_per_m;
  return fmt::format("{}{}noise={}&seed={}", phantom, phantom.find('?') == std::string::npos ? '?' : '&',
                     deviation / (profile.high - profile.low), seed);
}

std::optional<WindowBox> WindowRule::follow(const BenchVolume& volume, const Vec3& place_W) {
  const WindowBox box = windowAround(volume.phantom().lattice().toIndex(place_W), volume.size());
  if (last_) {
    const Vec3i last = volume.size() - box.size;
    const auto stopped = [&](int axis) {
      const int first = box.first[axis];
      return first != last_->first[axis] && (first == 0 || first == last[axis]);
    };
    const bool near = (box.first - last_->first).cwiseAbs().maxCoeff() < kRecentreVoxels;
    if (near && !stopped(0) && !stopped(1) && !stopped(2)) return std::nullopt;
  }
  last_ = box;
  return box;
}

const SampleWindow& WindowFollower::around(const Vec3& place_W) {
  if (const auto box = rule_.follow(volume_, place_W)) volume_.gather(*box, samples_, window_);
  return window_;
}

}  // namespace palpate
