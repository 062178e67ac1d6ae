// SPDX-License-Identifier: Apache-2.0
// engine/files/vector_file.hpp: a gradient field as an OpenVDB file of one Vec3s grid, brick by brick.
//
// The grid "gradient" has the volume's transform in millimetres ("unit" mm, as the volume's own file). Its vectors lie
// along the world's axes [density/mm]: metadata vector_type "covariant" and is_local_space false, as
// openvdb::tools::gradient makes them. The active voxels are those of the given bricks inside the domain
// ("palpate_domain"). All other vectors are 0. Thread: one. Memory: 12 bytes a voxel of the given bricks.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "base/byte_sink.hpp"
#include "base/lattice.hpp"

namespace palpate {

class VectorFile {
 public:
  virtual ~VectorFile() = default;

  // Sets a brick's 512 gradients, i fastest, along the lattice's axes [density/m]. Once for each brick.
  virtual void setBrick(const Vec3i& brick, std::span<const Eigen::Vector3f> gradients_L_per_m) = 0;
  virtual void write(const ByteSink& sink) const = 0;  // throws what the sink throws
};

// Throws Error(kBadInput, `name`) if voxels are too small for OpenVDB.
[[nodiscard]] std::unique_ptr<VectorFile> makeVectorFile(const Vec3i& size, const Lattice& lattice,
                                                         const std::string& name);

}  // namespace palpate
