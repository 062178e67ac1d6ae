// SPDX-License-Identifier: Apache-2.0
#include "tests/damage/vdb_grids.hpp"

#include <cstdint>
#include <fstream>

#include <openvdb/openvdb.h>

namespace palpate::damage {
namespace {

// Voxels of noise, so that leaves are stored.
template <class Grid>
typename Grid::Ptr noise(const std::string& name, int size, std::uint32_t seed) {
  const auto grid = Grid::create();
  grid->setName(name);
  auto values = grid->getAccessor();
  std::uint32_t random = seed;
  for (const openvdb::Coord& voxel : openvdb::CoordBBox(openvdb::Coord(0), openvdb::Coord(size - 1))) {
    values.setValueOn(voxel, static_cast<typename Grid::ValueType>((random = random * 1664525U + 1013904223U) >> 20));
  }
  return grid;
}

// OpenVDB gives every file a random name of 36 letters at byte 21. This overwrites it.
void setName(const std::string& path) {
  constexpr std::streamoff kNameAt = 21;
  std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
  file.seekp(kNameAt);
  file << "00000000-0000-0000-0000-000000000000";
}

}  // namespace

void writeVdbGrids(const std::string& path) {
  openvdb::initialize();
  openvdb::GridPtrVec grids = {noise<openvdb::FloatGrid>("density", 12, 1), noise<openvdb::Int32Grid>("mask", 9, 2),
                               noise<openvdb::DoubleGrid>("distance", 10, 3)};
  openvdb::io::File(path).write(grids);
  setName(path);
}

}  // namespace palpate::damage
