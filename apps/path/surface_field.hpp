// SPDX-License-Identifier: Apache-2.0
// apps/path/surface_field.hpp: what path building reads of a volume: density, gradient, isovalue, extent.
//
// World frame [m]. Above the isovalue is object, at or below it background; normals point out of the object.
#pragma once

#include <optional>

#include "base/lattice.hpp"
#include "base/vec.hpp"

namespace palpate {

// Samples along the edge of a block. A whole field is read block by block; blocks are as large as a volume's bricks.
inline constexpr int kFieldBlock = 8;
inline constexpr int kFieldBlockSamples = kFieldBlock * kFieldBlock * kFieldBlock;

class SurfaceField {
 public:
  virtual ~SurfaceField() = default;
  // Density and its gradient [density/m] at a point; false outside the volume, where nothing is known.
  virtual bool sample(const Vec3& p_W, double& density, Vec3& gradient_W) const = 0;
  // The same density alone, for fields that have it for less; empty outside the volume.
  [[nodiscard]] virtual std::optional<double> density(const Vec3& p_W) const {
    double density = 0;
    Vec3 gradient_W;
    if (!sample(p_W, density, gradient_W)) return std::nullopt;
    return density;
  }
  [[nodiscard]] virtual double isovalue() const = 0;         // tau [density]
  [[nodiscard]] virtual const Lattice& lattice() const = 0;  // where the samples lie
  [[nodiscard]] virtual Vec3i size() const = 0;              // samples along the lattice's axes [voxel]
  // Reads the block whose first sample is kFieldBlock * block. If all its densities are equal, sets values[0] only and
  // returns true. Else fills `values`, i fastest, and returns false. Values outside size() may be anything.
  virtual bool readBlock(const Vec3i& block, float* values) const = 0;
};

}  // namespace palpate
