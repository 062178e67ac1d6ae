// SPDX-License-Identifier: Apache-2.0
// The file of vectors (engine/files/vector_file.hpp).
#include <openvdb/openvdb.h>

#include "base/units.hpp"
#include "engine/vdb/vdb_grid.hpp"
#include "engine/vdb/vdb_parts.hpp"
#include "engine/vdb/vdb_stream.hpp"

namespace palpate {
namespace {

class VdbVectors final : public VectorFile {
 public:
  VdbVectors(const Vec3i& size, const Lattice& lattice, const std::string& name) : size_(size), lattice_(lattice) {
    openvdb::initialize();
    grid_ = openvdb::Vec3SGrid::create(openvdb::Vec3f(0, 0, 0));
    grid_->setName("gradient");
    grid_->setVectorType(openvdb::VEC_COVARIANT);
    grid_->setIsInWorldSpace(true);
    grid_->setTransform(vdbTransform(lattice, kMillimetresPerMetre, name));
    grid_->insertMeta("unit", openvdb::StringMetadata("mm"));
    grid_->insertMeta(kVdbVectorUnitKey, openvdb::StringMetadata("density/mm"));
    grid_->insertMeta(kVdbDomainKey, openvdb::Vec3IMetadata(openvdb::Vec3i(size.x(), size.y(), size.z())));
    grid_->setCreator(kVdbCreator);
  }

  void setBrick(const Vec3i& brick, std::span<const Eigen::Vector3f> gradients_L_per_m) override {
    const Vec3i first = brick * kBrickSize;
    const Vec3i end = (first.array() + kBrickSize).min(size_.array()).matrix() - first;
    using VectorLeaf = openvdb::Vec3STree::LeafNodeType;
    auto leaf =
        std::make_unique<VectorLeaf>(openvdb::Coord(first.x(), first.y(), first.z()), openvdb::Vec3f(0, 0, 0), false);
    for (int k = 0; k < end.z(); ++k) {
      for (int j = 0; j < end.y(); ++j) {
        for (int i = 0; i < end.x(); ++i) {
          const std::size_t from = (static_cast<std::size_t>(k) * kBrickSize + j) * kBrickSize + i;
          const Vec3 g_W = lattice_.gradientToWorld(gradients_L_per_m[from].cast<double>());
          const Eigen::Vector3f mm = (g_W * kMetresPerMillimetre).cast<float>();
          leaf->setValueOn(openvdb::Coord(i, j, k), openvdb::Vec3f(mm.x(), mm.y(), mm.z()));
        }
      }
    }
    grid_->tree().addLeaf(leaf.release());
  }

  void write(const ByteSink& sink) const override { streamGrid(grid_, sink); }

 private:
  Vec3i size_;
  Lattice lattice_;
  openvdb::Vec3SGrid::Ptr grid_;
};

}  // namespace

std::unique_ptr<VectorFile> makeVdbVectors(const Vec3i& size, const Lattice& lattice, const std::string& name) {
  return std::make_unique<VdbVectors>(size, lattice, name);
}

}  // namespace palpate
