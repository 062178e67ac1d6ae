// SPDX-License-Identifier: Apache-2.0
// servo/window/sample_window.hpp: the volume samples around the tool, from the engine to the servo.
//
// A window is a box of volume samples. Each sample has density and gradient. So one trilinear fetch gives both, and the
// servo never computes differences. Frames: W world [m]; L the window's lattice [voxel] (base/lattice.hpp). A face of
// the window may be a face of the volume. Beyond that face is free space, and an object that reaches it has a cut face.
#pragma once

#include <array>
#include <cstdint>
#include <type_traits>

#include "base/lattice.hpp"

namespace palpate {

// One sample; the layout is shared with the window kernel (a vec4). Gradient along the lattice's axes [density/m].
struct Sample {
  float gradient_i = 0;
  float gradient_j = 0;
  float gradient_k = 0;
  float density = 0;
};
static_assert(sizeof(Sample) == 16 && std::is_trivially_copyable_v<Sample>);

enum class Place : std::uint8_t {
  kInside,        // between samples of the window: density and gradient are valid
  kBeyondVolume,  // past a face of the volume: free space; density is -infinity, gradient zero
  kBeyondWindow,  // the window does not reach there: nothing is known
};

struct Fetch {
  double density = 0;              // trilinear [density]
  Vec3 gradient_W = Vec3::Zero();  // trilinear, in the world [density/m]
  Place place = Place::kBeyondWindow;
};

// A window and its placement. The samples lie in storage with another owner (a mapped GPU buffer, or a vector).
struct SampleWindow {
  Lattice lattice;                       // its sample (0, 0, 0) is the window's first
  Vec3i size = Vec3i::Zero();            // samples along i, j, k, each >= 2 in a usable window [voxel]
  std::array<bool, 3> low_is_border{};   // per axis: the first sample is the volume's first
  std::array<bool, 3> high_is_border{};  // per axis: the last sample is the volume's last
  std::uint64_t version = 0;             // counts publications; 0: nothing published yet
  std::uint64_t edit_version = 0;        // the volume edit that this window holds
  std::int64_t stamp_ns = 0;             // when it was published, on the servo's clock [ns]
  const Sample* samples = nullptr;       // size.x * size.y * size.z, i fastest

  [[nodiscard]] bool usable() const noexcept { return version != 0 && samples != nullptr && size.minCoeff() >= 2; }
};

}  // namespace palpate
