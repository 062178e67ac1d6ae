// SPDX-License-Identifier: Apache-2.0
// apps/bench/bench_volume.hpp: a phantom with its samples in plain memory, and the windows that an engine would gather
// from them.
//
// No Vulkan: samples come from the CPU twin (engine/reference), whose gradients are bit for bit those of the GPU. The
// program's engine leaves the gradients of bricks far from the surface zero, these windows have them all. Frame W
// [m]. One thread. Cost: making one computes the gradient of every voxel; gathering a window copies 512 KiB.
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

class BenchVolume {
 public:
  explicit BenchVolume(const std::string& name);  // "phantom:..."; throws Error as makePhantom does

  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] const Phantom& phantom() const noexcept { return *phantom_; }
  // Rounded to float once, as the program has it.
  [[nodiscard]] double isovalue() const noexcept { return isovalue_; }
  [[nodiscard]] double maximum() const noexcept { return maximum_; }  // [density]
  [[nodiscard]] double voxel_m() const noexcept { return phantom_->lattice().smallestSpacing(); }
  [[nodiscard]] const Vec3i& size() const noexcept { return phantom_->size(); }

  // For algorithms that touch a mesh (engine/field/isosurface_mesh.hpp).
  [[nodiscard]] const std::shared_ptr<const TriangleMesh>& isosurface() const noexcept { return isosurface_; }

  // The least number of voxels between the point and a face of the volume; negative outside [voxel].
  [[nodiscard]] double borderDistance(const Vec3& p_W) const;

  // Fills `samples` with the box and describes it in `window`, whose version becomes one more.
  void gather(const WindowBox& box, std::vector<Sample>& samples, SampleWindow& window) const;

  // The whole volume as one window: what the samples say anywhere.
  [[nodiscard]] SampleWindow whole() const;

 private:
  std::string name_;
  std::unique_ptr<Phantom> phantom_;
  double isovalue_;
  double maximum_ = 0;
  std::shared_ptr<const TriangleMesh> isosurface_;
  std::vector<Sample> samples_;  // of every voxel, i fastest
};

// "phantom:NAME?size=64" with noise whose standard deviation is that of a surface moved by `noise_voxel` smallest
// voxels where the density is steepest; unchanged for none. Throws Error as makePhantom does.
[[nodiscard]] std::string withNoise(const std::string& phantom, double noise_voxel, std::uint64_t seed);

// Where the newest window lies, by the engine's rule (engine/service/engine.cpp): a new one as soon as its place is six
// voxels from the middle of the last, or the volume's border stops the box.
class WindowRule {
 public:
  // The box to gather now, or nothing while the last one still serves.
  [[nodiscard]] std::optional<WindowBox> follow(const BenchVolume& volume, const Vec3& place_W);

 private:
  std::optional<WindowBox> last_;
};

// Where the window belongs for a tool at `hip_W`, by what the algorithm said in the last tick: at the surface that it
// holds, otherwise at the tool (engine/service/window_focus.hpp, without its lead).
[[nodiscard]] inline const Vec3& windowPlace(const TickOutput& last, const Vec3& hip_W) noexcept {
  return last.at_surface ? last.surface_W : hip_W;
}

// One window that follows without delay; each algorithm has its own, since each says where it wants it.
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
