// SPDX-License-Identifier: Apache-2.0
// engine/vdb/vdb_stream.hpp: what all writers of OpenVDB files share. Private to engine/vdb.
#pragma once

#include <string>

#include <openvdb/openvdb.h>

#include "base/byte_sink.hpp"
#include "base/lattice.hpp"

namespace palpate {

// A lattice as OpenVDB's transform from voxels to the world. `units_per_metre`: sets the world's unit of length. Throws
// Error(kBadInput, `name`) if voxels are too small for OpenVDB.
[[nodiscard]] openvdb::math::Transform::Ptr vdbTransform(const Lattice& lattice, double units_per_metre,
                                                         const std::string& name);

// Writes a file with one grid and its checksum (vdb_checksum.hpp). Throws what the sink throws.
void streamGrid(const openvdb::GridBase::ConstPtr& grid, const ByteSink& sink);

}  // namespace palpate
