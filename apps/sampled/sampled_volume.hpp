// SPDX-License-Identifier: Apache-2.0
// apps/sampled/sampled_volume.hpp: a volume with its samples in plain memory, and windows of these samples, without
// Vulkan.
//
// The samples come from the CPU twin (engine/reference), whose gradients equal those of the GPU bit for bit. These
// windows have the gradients of all bricks; those of the engine are zero far from the surface. World frame W [m]. One
// thread. Cost: the constructor computes the gradient of every voxel; a window of 32^3 samples copies 512 KiB.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/triangle_mesh.hpp"
#include "engine/field/volume.hpp"
#include "engine/gradient/gradient_operator.hpp"
#include "engine/passes/window_pass.hpp"
#include "servo/algorithms/transfer_function.hpp"
#include "servo/window/sample_window.hpp"

namespace palpate {

// A volume whose voxels are given by a density [density] at their centres [m], rounded to float. Throws Error as
// Volume::fromBricks does.
[[nodiscard]] Volume volumeOfDensity(const Vec3i& size, const Lattice& lattice, const std::string& name,
                                     const std::function<double(const Vec3& p_W)>& density);

class SampledVolume {
 public:
  // `isovalue` is rounded to float, as in the program [density].
  SampledVolume(Volume volume, double isovalue, const GradientOperator& gradient_operator = {});

  [[nodiscard]] double isovalue() const noexcept { return isovalue_; }                           // [density]
  [[nodiscard]] double maximum() const noexcept { return volume_.maximum(); }                    // [density]
  [[nodiscard]] double voxel_m() const noexcept { return volume_.lattice().smallestSpacing(); }  // [m]
  [[nodiscard]] const Vec3i& size() const noexcept { return volume_.size(); }                    // [voxel]
  [[nodiscard]] const Lattice& lattice() const noexcept { return volume_.lattice(); }
  // For algorithms that make a table of densities of their own.
  [[nodiscard]] DensityScale scale() const noexcept;
  // The mesh for algorithms that touch one (engine/field/isosurface_mesh.hpp); made at the first call.
  [[nodiscard]] const TriangleMesh& isosurface() const;

  // Copies the samples of the box to `samples`, and lets `window` say where they lie. Its version, stamp and pointer
  // are the caller's.
  void gather(const WindowBox& box, Sample* samples, SampleWindow& window) const;
  // The same into a vector; increments the window's version and lets it point there.
  void gather(const WindowBox& box, std::vector<Sample>& samples, SampleWindow& window) const;

  // The whole volume as one window.
  [[nodiscard]] SampleWindow whole() const;

 private:
  Volume volume_;
  double isovalue_;
  std::vector<Sample> samples_;  // of every voxel, i fastest
  mutable std::optional<TriangleMesh> isosurface_;
};

}  // namespace palpate
