// SPDX-License-Identifier: Apache-2.0
// engine/files/vdb_module.hpp: what the module "openvdb" (engine/vdb, base/module.hpp) does with files. Private to
// engine/files and engine/vdb.
#pragma once

#include <memory>
#include <string>

#include "base/byte_sink.hpp"
#include "engine/files/formats.hpp"
#include "engine/files/vector_file.hpp"
#include "engine/files/volume_file.hpp"

namespace palpate {

struct VdbModule {
  static constexpr const char* kModule = "openvdb";
  static constexpr const char* kTable = "palpate_vdb";

  Volume (*read)(const ReadRequest& request);                                                           // readers.hpp
  void (*write)(const Volume& volume, const std::string& name, LengthUnit unit, const ByteSink& sink);  // writers.hpp
  std::unique_ptr<VectorFile> (*vectors)(const Vec3i& size, const Lattice& lattice, const std::string& name);
  std::size_t (*readAlone)(const std::string& name);  // library_read.hpp
};

}  // namespace palpate
