// SPDX-License-Identifier: Apache-2.0
// engine/volume/grid.hpp: what a Volume holds. Private to engine/volume: it is the one header that includes OpenVDB.
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

#include "engine/volume/volume.hpp"

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

// Metadata of OpenVDB files that Palpate wrote: the domain's size [voxel], whose first voxel is the grid's (0,0,0).
inline constexpr const char* kVdbDomainKey = "palpate_domain";

// Builds the grid brick by brick. Throws Error(kBadInput): a dimension below 2, a bad lattice, NaN or infinite values
// (with their count and the first one's index). Layers of bricks may be asked for from several threads at once, which a
// source of values that are all there already can bear.
enum class SourceCalls { kInOrder, kFromSeveralThreads };
[[nodiscard]] std::unique_ptr<Volume::Grid> buildGrid(const Vec3i& size, const Lattice& lattice, VolumeFacts facts,
                                                      const BrickSource& source,
                                                      SourceCalls calls = SourceCalls::kInOrder);

// A leaf of a brick's 512 densities (i fastest; VDB's own run k fastest) with the voxels inside the domain active.
[[nodiscard]] std::unique_ptr<ScalarTree::LeafNodeType> makeLeaf(const Vec3i& size, const Vec3i& brick,
                                                                 const float* values);

}  // namespace palpate
