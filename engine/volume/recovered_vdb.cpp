// SPDX-License-Identifier: Apache-2.0
#include "engine/volume/recovered_vdb.hpp"

#include <sstream>

#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#include "base/error.hpp"
#include "base/units.hpp"
#include "engine/volume/grid.hpp"

namespace palpate {
namespace {

// Of row vectors: rows 0 to 2 are the axes. A level set's numbers are lengths, so it stays in metres.
openvdb::math::Transform::Ptr transformOf(const Volume& volume, double units_per_metre) {
  const Lattice& lattice = volume.lattice();
  openvdb::Mat4R matrix = openvdb::Mat4R::identity();
  for (int axis = 0; axis < 3; ++axis) {
    for (int n = 0; n < 3; ++n) matrix(axis, n) = lattice.R_WL(n, axis) * lattice.spacing_m[axis] * units_per_metre;
    matrix(3, axis) = lattice.origin_W[axis] * units_per_metre;
  }
  try {
    return openvdb::math::Transform::createLinearTransform(matrix);
  } catch (const openvdb::Exception&) {
    throw Error(Error::Code::kBadInput, volume.facts().source, "its voxels are too small for an OpenVDB file",
                "give the volume larger voxels");
  }
}

}  // namespace

std::string vdbBytes(const Volume& volume) {
  openvdb::initialize();
  const openvdb::FloatGrid::Ptr grid = volume.grid().field->deepCopy();
  grid->setName("density");
  grid->setTransform(transformOf(volume, kMillimetresPerMetre));
  grid->insertMeta("unit", openvdb::StringMetadata("mm"));
  grid->tree().root().setBackground(volume.minimum(), false);
  std::ostringstream out(std::ios::binary);
  openvdb::io::Stream(out).write({grid});
  return std::move(out).str();
}

}  // namespace palpate
