// SPDX-License-Identifier: Apache-2.0
// The module "openvdb": two tables, one for each room that calls it.
#include "engine/vdb/vdb_grid.hpp"
#include "engine/vdb/vdb_parts.hpp"

namespace {

std::unique_ptr<palpate::Volume::Grid> buildByLayers(const palpate::Vec3i& size, const palpate::Lattice& lattice,
                                                     palpate::VolumeFacts facts, const palpate::LayerSource& layers) {
  return palpate::buildGridByLayers(size, lattice, std::move(facts), layers);
}

}  // namespace

extern "C" const palpate::FieldModule palpate_field = {palpate::buildGrid, buildByLayers, palpate::vdbMeshDistances};
extern "C" const palpate::VdbModule palpate_vdb = {palpate::readVdbVolume, palpate::writeVdbVolume,
                                                   palpate::makeVdbVectors, palpate::readWithOpenVdbAlone};
