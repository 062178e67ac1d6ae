// SPDX-License-Identifier: Apache-2.0
// engine/field/grid.hpp: what a Volume holds. It is the one header of the room that includes OpenVDB; for
// the room itself and for readers and writers of OpenVDB files.
//
// Leaves lie at multiples of 8 from (0,0,0), so a leaf is a brick; a constant brick is a tile of the level above.
// Voxels of a leaf outside the domain repeat the nearest voxel inside and are inactive; all else outside is background,
// the lowest density that the volume was made with. The grid's transform is the
// identity (VDB refuses voxels below 15 micrometres, its unit being the metre); `lattice` is the truth.
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

// Metadata of OpenVDB files that Palpate wrote: the domain's size [voxel], whose first voxel is the grid's (0,0,0);
// and, where the volume was sculpted, at which isovalue, a double [density, of a level set minus the distance in
// metres].
inline constexpr const char* kVdbDomainKey = "palpate_domain";
inline constexpr const char* kVdbIsovalueKey = "palpate_isovalue";
// Of a file of gradients: the unit of its vectors.
inline constexpr const char* kVdbVectorUnitKey = "vector_unit";
inline constexpr const char* kVdbCreator = "Palpate";

// Builds the grid brick by brick. Throws Error(kBadInput): a dimension below 1, a bad lattice, NaN or infinite values
// (with their count and the first one's index); and what the source throws.
[[nodiscard]] std::unique_ptr<Volume::Grid> buildGrid(const Vec3i& size, const Lattice& lattice, VolumeFacts facts,
                                                      const BrickSource& source);

// The same by all processors, as Volume::fromLayers. For readers that have leaves: the one whose 512 values are exactly
// this brick's, all inside the domain, or none; then, and where a value is not finite, the layer's source is asked.
// What the leaf holds is moved out of it, without a copy: nobody may look at it again. Called for several bricks at
// once.
using LeafSource = std::function<ScalarTree::LeafNodeType*(const Vec3i& brick)>;
[[nodiscard]] std::unique_ptr<Volume::Grid> buildGridByLayers(const Vec3i& size, const Lattice& lattice,
                                                              VolumeFacts facts, const LayerSource& layers,
                                                              const LeafSource& leaf_of = nullptr);

// A brick's 512 values from i fastest, as Palpate has them, to k fastest, as VDB has them, or back.
void turnBrick(const float* from, float* to);

// A leaf of a brick's 512 densities (i fastest; VDB's own run k fastest) with the voxels inside the domain active.
[[nodiscard]] std::unique_ptr<ScalarTree::LeafNodeType> makeLeaf(const Vec3i& size, const Vec3i& brick,
                                                                 const float* values);

}  // namespace palpate
