// SPDX-License-Identifier: Apache-2.0
#include "engine/files/vdb_module.hpp"

#include "base/module.hpp"
#include "engine/files/readers.hpp"
#include "engine/files/writers.hpp"

namespace palpate {

Volume readVdb(const ReadRequest& request) {
  return loadModule<VdbModule>().read(request);
}

void writeVdb(const Volume& volume, const std::string& name, LengthUnit unit, const ByteSink& sink) {
  loadModule<VdbModule>().write(volume, name, unit, sink);
}

std::unique_ptr<VectorFile> makeVectorFile(const Vec3i& size, const Lattice& lattice, const std::string& name) {
  return loadModule<VdbModule>().vectors(size, lattice, name);
}

}  // namespace palpate
