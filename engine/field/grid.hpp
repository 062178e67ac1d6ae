// SPDX-License-Identifier: Apache-2.0
// engine/field/grid.hpp: the OpenVDB grid behind a Volume. No other header of the room includes OpenVDB. For the room
// itself and for readers and writers of OpenVDB files.
//
// Leaves lie at multiples of 8 from (0,0,0), so a leaf is a brick. A constant brick is a tile of the level above.
// Voxels of a leaf outside the domain repeat the nearest voxel inside and are inactive. All other voxels outside are
// background: the lowest density that the volume was made with. The grid's transform is the identity, because VDB
// refuses voxels below 15 micrometres where its unit is the metre; `lattice` says where the voxels lie.
#pragma once

#include <functional>
#include <memory>

#include <openvdb/Grid.h>
#include <openvdb/tree/Tree.h>

#include "engine/field/volume.hpp"

namespace palpate {

using ScalarTree = openvdb::tree::Tree4<float, 5, 4, 3>::Type;  // openvdb::FloatTree
using ScalarGrid = openvdb::Grid<ScalarTree>;                   // openvdb::FloatGrid

struct Volume::Grid {
  Vec3i size = Vec3i::Zero();  // [voxel]
  Lattice lattice;
  VolumeFacts facts;
  float minimum = 0;
  float maximum = 0;
  ScalarGrid::Ptr field;
};

using BrickSource = Volume::BrickSource;
using LayerSource = Volume::LayerSource;

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

// Reorders a brick's 512 values from Palpate's order (i fastest) to VDB's (k fastest), or back.
void turnBrick(const float* from, float* to);

// Makes a leaf from a brick's 512 densities (i fastest). Its voxels inside the domain are active.
[[nodiscard]] std::unique_ptr<ScalarTree::LeafNodeType> makeLeaf(const Vec3i& size, const Vec3i& brick,
                                                                 const float* values);

}  // namespace palpate
