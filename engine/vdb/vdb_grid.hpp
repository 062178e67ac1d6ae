// SPDX-License-Identifier: Apache-2.0
// engine/vdb/vdb_grid.hpp: the OpenVDB grid behind a Volume. For this room, which reads and writes OpenVDB files, and
// for tests.
//
// Leaves lie at multiples of 8 from (0,0,0), so a leaf is a brick. A constant brick is a tile of the level above.
// Voxels of a leaf outside the domain repeat the nearest voxel inside and are inactive. All other voxels outside are
// background: the lowest density that the volume was made with. The grid's transform is the identity, because VDB
// refuses voxels below 15 micrometres where its unit is the metre; `lattice` says where the voxels lie.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <openvdb/Grid.h>
#include <openvdb/tree/Tree.h>

#include "engine/field/field_grid.hpp"

namespace palpate {

using ScalarTree = openvdb::tree::Tree4<float, 5, 4, 3>::Type;  // openvdb::FloatTree
using ScalarGrid = openvdb::Grid<ScalarTree>;                   // openvdb::FloatGrid

class VdbGrid final : public FieldGrid {
 public:
  VdbGrid() : grid(ScalarGrid::create(0.0F)) {}

  [[nodiscard]] float value(const Vec3i& voxel) const override;
  void readBox(const Vec3i& first, const Vec3i& size, float* values) const override;
  [[nodiscard]] std::optional<float> constantOf(const Vec3i& brick) const override;
  bool readBrick(const Vec3i& brick, float* values) const override;
  void setBrick(const Vec3i& size, const Vec3i& brick, const float* values) override;
  void setConstantBrick(const Vec3i& brick, float value) override;
  [[nodiscard]] std::size_t storedBytes() const override;
  [[nodiscard]] std::size_t storedBricks() const override;

  ScalarGrid::Ptr grid;
};

// The OpenVDB grid of a volume. There is no other kind of FieldGrid.
[[nodiscard]] inline const ScalarGrid::Ptr& vdbGridOf(const Volume& volume) {
  return static_cast<const VdbGrid&>(*volume.grid().field).grid;
}

// Metadata of OpenVDB files that Palpate writes. The domain's size [voxel]; its first voxel is the grid's (0,0,0). For
// a sculpted volume, the isovalue, a double [density; for a level set, minus the distance in metres].
inline constexpr const char* kVdbDomainKey = "palpate_domain";
inline constexpr const char* kVdbIsovalueKey = "palpate_isovalue";
// In a file of gradients: the unit of its vectors.
inline constexpr const char* kVdbVectorUnitKey = "vector_unit";
inline constexpr const char* kVdbCreator = "Palpate";

// Builds the grid brick by brick. Throws Error(kBadInput) for a dimension below 1, a bad lattice, and NaN or infinite
// values (with their count and the index of the first); also throws what the source throws.
[[nodiscard]] std::unique_ptr<Volume::Grid> buildGrid(const Vec3i& size, const Lattice& lattice, VolumeFacts facts,
                                                      const BrickSource& source);

// For readers that already have OpenVDB leaves: returns the leaf whose 512 values are exactly those of this brick, or
// null. All 512 voxels must lie inside the domain. Several threads call it at once.
using LeafSource = std::function<ScalarTree::LeafNodeType*(const Vec3i& brick)>;
// The same on all processors, as Volume::fromLayers does it. A leaf's values are moved into the grid without a copy, so
// nobody may use the leaf again. The source of the layer gives the other bricks, and those whose leaf holds a value
// that is not finite.
[[nodiscard]] std::unique_ptr<Volume::Grid> buildGridByLayers(const Vec3i& size, const Lattice& lattice,
                                                              VolumeFacts facts, const LayerSource& layers,
                                                              const LeafSource& leaf_of = nullptr);

// Signed distances as FieldModule::meshDistances has them.
[[nodiscard]] std::vector<float> vdbMeshDistances(const std::vector<Vec3>& points, const std::vector<Vec3i>& triangles,
                                                  const Vec3i& size, float band, float depth);

}  // namespace palpate
