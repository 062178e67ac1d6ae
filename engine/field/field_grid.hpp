// SPDX-License-Identifier: Apache-2.0
// engine/field/field_grid.hpp: what holds the densities of a Volume. The one kind of grid is OpenVDB's (engine/vdb), in
// the module "openvdb" (base/module.hpp), which is loaded with the first volume. For engine/field and engine/vdb.
//
// Frame: index space of the volume [voxel]. All voxels and bricks are those of its domain. Thread: as Volume.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "engine/field/volume.hpp"

namespace palpate {

class FieldGrid {
 public:
  virtual ~FieldGrid() = default;

  [[nodiscard]] virtual float value(const Vec3i& voxel) const = 0;
  // The voxels of a box, i fastest.
  virtual void readBox(const Vec3i& first, const Vec3i& size, float* values) const = 0;
  [[nodiscard]] virtual std::optional<float> constantOf(const Vec3i& brick) const = 0;  // empty: the brick is stored
  virtual bool readBrick(const Vec3i& brick, float* values) const = 0;                  // as Volume::readBrick()

  // As Volume has them; `size` is the domain's.
  virtual void setBrick(const Vec3i& size, const Vec3i& brick, const float* values) = 0;
  virtual void setConstantBrick(const Vec3i& brick, float value) = 0;

  [[nodiscard]] virtual std::size_t storedBytes() const = 0;
  [[nodiscard]] virtual std::size_t storedBricks() const = 0;
};

struct Volume::Grid {
  Vec3i size = Vec3i::Zero();  // [voxel]
  Lattice lattice;
  VolumeFacts facts;
  float minimum = 0;
  float maximum = 0;
  std::unique_ptr<FieldGrid> field;
};

using BrickSource = Volume::BrickSource;
using LayerSource = Volume::LayerSource;

struct FieldModule {
  static constexpr const char* kModule = "openvdb";
  static constexpr const char* kTable = "palpate_field";

  // As Volume::fromBricks() and Volume::fromLayers().
  std::unique_ptr<Volume::Grid> (*build)(const Vec3i& size, const Lattice& lattice, VolumeFacts facts,
                                         const BrickSource& source);
  std::unique_ptr<Volume::Grid> (*buildByLayers)(const Vec3i& size, const Lattice& lattice, VolumeFacts facts,
                                                 const LayerSource& layers);
  // Signed distances of the voxels of a box to a closed mesh, in voxels, i fastest; the mesh is in the box's index
  // space. They are exact within `band` outside and `depth` inside; farther away only the sign is.
  std::vector<float> (*meshDistances)(const std::vector<Vec3>& points, const std::vector<Vec3i>& triangles,
                                      const Vec3i& size, float band, float depth);
};

}  // namespace palpate
