// SPDX-License-Identifier: Apache-2.0
// apps/bench/bench_volume.hpp: a phantom with its samples in plain memory, and windows of these samples, without
// Vulkan.
//
// The samples come from the CPU twin (engine/reference), whose gradients equal those of the GPU bit for bit. These
// windows have the gradients of all bricks; those of the engine are zero far from the surface. World frame W [m]. One
// thread. Cost: the constructor computes the gradient of every voxel; a window copies 512 KiB.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/triangle_mesh.hpp"
#include "engine/passes/window_pass.hpp"
#include "engine/phantoms/phantom.hpp"
#include "engine/reference/dense_field.hpp"
#include "servo/algorithms/algorithm.hpp"
#include "servo/window/sample_window.hpp"

namespace palpate {

// Distance from the point to the nearest face of the phantom's volume; negative outside [voxel].
[[nodiscard]] double borderDistance(const Phantom& phantom, const Vec3& p_W);

class BenchVolume {
 public:
  explicit BenchVolume(const std::string& name);  // "phantom:..."; throws Error as makePhantom does

  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] const Phantom& phantom() const noexcept { return *phantom_; }
  // Rounded to float, as in the program [density].
  [[nodiscard]] double isovalue() const noexcept { return isovalue_; }
  [[nodiscard]] double maximum() const noexcept { return maximum_; }  // [density]
  [[nodiscard]] double voxel_m() const noexcept { return phantom_->lattice().smallestSpacing(); }
  [[nodiscard]] const Vec3i& size() const noexcept { return phantom_->size(); }

  // The mesh for algorithms that touch one (engine/field/isosurface_mesh.hpp).
  [[nodiscard]] const TriangleMesh& isosurface() const noexcept { return isosurface_; }

  [[nodiscard]] double borderDistance(const Vec3& p_W) const { return palpate::borderDistance(*phantom_, p_W); }

  // Copies the samples of the box into `samples`, lets `window` describe them, and increments the window's version.
  void gather(const WindowBox& box, std::vector<Sample>& samples, SampleWindow& window) const;

  // The whole volume as one window.
  [[nodiscard]] SampleWindow whole() const;

 private:
  std::string name_;
  std::unique_ptr<Phantom> phantom_;
  double isovalue_;
  double maximum_ = 0;
  TriangleMesh isosurface_;
  std::vector<Sample> samples_;  // of every voxel, i fastest
};

// The phantom's name with noise added to it. The noise's standard deviation [density] is the change of density over
// `noise_voxel` smallest voxels where the density is steepest. 0 leaves the name as it is. Throws Error as makePhantom
// does.
[[nodiscard]] std::string withNoise(const std::string& phantom, double noise_voxel, std::uint64_t seed);

// When to gather a new window, by the engine's rule (engine/service/engine.cpp): when its place is six voxels from the
// middle of the last window, or when the border of the volume stops the box.
class WindowRule {
 public:
  // The box to gather now; empty while the last window still serves.
  [[nodiscard]] std::optional<WindowBox> follow(const BenchVolume& volume, const Vec3& place_W);

 private:
  std::optional<WindowBox> last_;
};

// The place of the window for a tool at `hip_W` [m]: at the surface point of the last tick if the algorithm held one,
// otherwise at the tool. As engine/service/window_focus.hpp, but without its lead.
[[nodiscard]] inline const Vec3& windowPlace(const TickOutput& last, const Vec3& hip_W) noexcept {
  return last.at_surface ? last.surface_W : hip_W;
}

// One window that follows its place without delay. Each algorithm has its own, since each has its own place.
class WindowFollower {
 public:
  explicit WindowFollower(const BenchVolume& volume) : volume_(volume) {}
  WindowFollower(const WindowFollower&) = delete;
  WindowFollower& operator=(const WindowFollower&) = delete;
  WindowFollower(WindowFollower&&) = default;
  WindowFollower& operator=(WindowFollower&&) = delete;
  const SampleWindow& around(const Vec3& place_W);

 private:
  const BenchVolume& volume_;
  WindowRule rule_;
  std::vector<Sample> samples_;
  SampleWindow window_;
};

}  // namespace palpate
