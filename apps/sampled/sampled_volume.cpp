// SPDX-License-Identifier: Apache-2.0
#include "apps/sampled/sampled_volume.hpp"

#include <algorithm>
#include <utility>

#include "engine/field/isosurface_mesh.hpp"
#include "engine/reference/dense_field.hpp"
#include "engine/reference/window.hpp"

namespace palpate {

Volume volumeOfDensity(const Vec3i& size, const Lattice& lattice, const std::string& name,
                       const std::function<double(const Vec3& p_W)>& density) {
  VolumeFacts facts;
  facts.source = name;
  return Volume::fromBricks(size, lattice, std::move(facts), [&](const Vec3i& brick, float* values) {
    for (int n = 0; n < kBrickVoxels; ++n) {
      const Vec3i in_brick(n % kBrickSize, n / kBrickSize % kBrickSize, n / kBrickSize / kBrickSize);
      // Outside the domain a brick repeats the nearest voxel inside.
      const Vec3i at = (kBrickSize * brick + in_brick).cwiseMin(size - Vec3i::Ones());
      values[n] = static_cast<float>(density(lattice.toWorld(at.cast<double>())));
    }
    return false;
  });
}

SampledVolume::SampledVolume(Volume volume, double isovalue, const GradientOperator& gradient_operator)
    : volume_(std::move(volume)),
      isovalue_(static_cast<float>(isovalue)),
      samples_(
          reference::windowSamples(reference::denseField(volume_), Vec3i::Zero(), volume_.size(), gradient_operator)) {}

DensityScale SampledVolume::scale() const noexcept {
  return {.contrast = maximum() - isovalue(), .voxel_m = voxel_m()};
}

const TriangleMesh& SampledVolume::isosurface() const {
  if (!isosurface_) isosurface_ = isosurfaceMesh(volume_, isovalue_);
  return *isosurface_;
}

void SampledVolume::gather(const WindowBox& box, Sample* samples, SampleWindow& window) const {
  for (int k = 0; k < box.size.z(); ++k) {
    for (int j = 0; j < box.size.y(); ++j) {
      const auto row = (static_cast<std::ptrdiff_t>(box.first.z() + k) * size().y() + box.first.y() + j) * size().x();
      samples = std::copy_n(samples_.begin() + row + box.first.x(), box.size.x(), samples);
    }
  }
  window.lattice = lattice().shifted(box.first);
  window.size = box.size;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    window.low_is_border[a] = box.first[axis] == 0;
    window.high_is_border[a] = box.first[axis] + box.size[axis] == size()[axis];
  }
}

void SampledVolume::gather(const WindowBox& box, std::vector<Sample>& samples, SampleWindow& window) const {
  samples.resize(static_cast<std::size_t>(box.size.prod()));
  gather(box, samples.data(), window);
  ++window.version;
  window.samples = samples.data();
}

SampleWindow SampledVolume::whole() const {
  SampleWindow window;
  window.lattice = lattice();
  window.size = size();
  window.low_is_border = window.high_is_border = {true, true, true};
  window.version = 1;
  window.samples = samples_.data();
  return window;
}

}  // namespace palpate
