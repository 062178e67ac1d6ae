// SPDX-License-Identifier: Apache-2.0
#include "engine/files/vector_file.hpp"

#include <openvdb/openvdb.h>

#include "base/units.hpp"
#include "engine/field/grid.hpp"
#include "engine/files/vdb_stream.hpp"

namespace palpate {

struct VectorFile::State {
  Vec3i size;
  Lattice lattice;
  openvdb::Vec3SGrid::Ptr grid;
};

VectorFile::VectorFile(const Vec3i& size, const Lattice& lattice, const std::string& name) {
  openvdb::initialize();
  const openvdb::Vec3SGrid::Ptr grid = openvdb::Vec3SGrid::create(openvdb::Vec3f(0, 0, 0));
  grid->setName("gradient");
  grid->setVectorType(openvdb::VEC_COVARIANT);
  grid->setIsInWorldSpace(true);
  grid->setTransform(vdbTransform(lattice, kMillimetresPerMetre, name));
  grid->insertMeta("unit", openvdb::StringMetadata("mm"));
  grid->insertMeta(kVdbVectorUnitKey, openvdb::StringMetadata("density/mm"));
  grid->insertMeta(kVdbDomainKey, openvdb::Vec3IMetadata(openvdb::Vec3i(size.x(), size.y(), size.z())));
  grid->setCreator(kVdbCreator);
  state_ = std::make_unique<State>(State{size, lattice, grid});
}

VectorFile::~VectorFile() = default;

void VectorFile::setBrick(const Vec3i& brick, std::span<const Eigen::Vector3f> gradients_L_per_m) {
  const Vec3i first = brick * kBrickSize;
  const Vec3i end = (first.array() + kBrickSize).min(state_->size.array()).matrix() - first;
  using Leaf = openvdb::Vec3STree::LeafNodeType;
  auto leaf = std::make_unique<Leaf>(openvdb::Coord(first.x(), first.y(), first.z()), openvdb::Vec3f(0, 0, 0), false);
  for (int k = 0; k < end.z(); ++k) {
    for (int j = 0; j < end.y(); ++j) {
      for (int i = 0; i < end.x(); ++i) {
        const std::size_t from = (static_cast<std::size_t>(k) * kBrickSize + j) * kBrickSize + i;
        const Vec3 g_W = state_->lattice.gradientToWorld(gradients_L_per_m[from].cast<double>());
        const Eigen::Vector3f mm = (g_W * kMetresPerMillimetre).cast<float>();
        leaf->setValueOn(openvdb::Coord(i, j, k), openvdb::Vec3f(mm.x(), mm.y(), mm.z()));
      }
    }
  }
  state_->grid->tree().addLeaf(leaf.release());
}

void VectorFile::write(const ByteSink& sink) const {
  streamGrid(state_->grid, sink);
}

}  // namespace palpate
