// SPDX-License-Identifier: Apache-2.0
// engine/vdb/vdb_parts.hpp: what the table of the module "openvdb" for files is made of (engine/files/vdb_module.hpp
// says what each does). Private to engine/vdb.
#pragma once

#include "engine/files/vdb_module.hpp"

namespace palpate {

[[nodiscard]] Volume readVdbVolume(const ReadRequest& request);
void writeVdbVolume(const Volume& volume, const std::string& name, LengthUnit unit, const ByteSink& sink);
[[nodiscard]] std::unique_ptr<VectorFile> makeVdbVectors(const Vec3i& size, const Lattice& lattice,
                                                         const std::string& name);
[[nodiscard]] std::size_t readWithOpenVdbAlone(const std::string& name);

}  // namespace palpate
