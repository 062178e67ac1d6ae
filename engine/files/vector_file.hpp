// SPDX-License-Identifier: Apache-2.0
// engine/files/vector_file.hpp: a gradient field as an OpenVDB file of one Vec3s grid, brick by brick.
//
// The grid "gradient" has the volume's transform in millimetres ("unit" mm, as the volume's own file) and its vectors
// are in the world, density/mm: metadata vector_type "covariant" and is_local_space false, as
// openvdb::tools::gradient makes them. Active are the voxels of the given bricks inside the domain, which
// "palpate_domain" names; all others are 0. Thread: one. Memory: 12 bytes a voxel of the given bricks.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "base/byte_sink.hpp"
#include "base/lattice.hpp"

namespace palpate {

class VectorFile {
 public:
  // Throws Error(kBadInput, `name`) where voxels are too small for OpenVDB.
  VectorFile(const Vec3i& size, const Lattice& lattice, const std::string& name);
  ~VectorFile();
  VectorFile(const VectorFile&) = delete;
  VectorFile& operator=(const VectorFile&) = delete;

  // A brick's 512 gradients, i fastest, along the lattice's axes [density/m]; each brick once.
  void setBrick(const Vec3i& brick, std::span<const Eigen::Vector3f> gradients_L_per_m);
  void write(const ByteSink& sink) const;  // throws what the sink throws

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace palpate
