// SPDX-License-Identifier: Apache-2.0
// Writes one OpenVDB grid of floats: a density, or a level set where the volume came from one.
//
// Leaves stay where they are; constant bricks are tiles. Outside the domain there is background: the lowest density, or
// the level set's largest distance. A density whose size is a multiple of the brick's is written without a copy. Its
// background then stays as it was, even if edits made lower densities.
#include <cmath>

#include <openvdb/openvdb.h>

#include "base/units.hpp"
#include "engine/vdb/vdb_grid.hpp"
#include "engine/vdb/vdb_parts.hpp"
#include "engine/vdb/vdb_stream.hpp"

namespace palpate {
namespace {

// Densities above 0 are inside, distances above 0 outside. Voxels at the largest distance do not belong to the narrow
// band.
void makeLevelSet(ScalarGrid& grid, float farthest_m, double units_per_metre) {
  for (auto value = grid.tree().beginValueAll(); value; ++value) {
    const float density = *value;
    value.setValue(static_cast<float>(-units_per_metre * static_cast<double>(density)));
    value.setActiveState(value.isValueOn() && std::abs(density) < farthest_m);
  }
  grid.tree().root().setBackground(static_cast<float>(units_per_metre * static_cast<double>(farthest_m)), false);
  grid.setGridClass(openvdb::GRID_LEVEL_SET);
  grid.setName("surface");
}

}  // namespace

void writeVdbVolume(const Volume& volume, const std::string& name, LengthUnit unit, const ByteSink& sink) {
  openvdb::initialize();
  const double units_per_metre = unit == LengthUnit::kMetre ? 1 : kMillimetresPerMetre;
  const auto transform = vdbTransform(volume.lattice(), units_per_metre, name);
  const Vec3i last = volume.size() - Vec3i::Ones();
  openvdb::MetaMap about;
  about.insertMeta("unit", openvdb::StringMetadata(unit == LengthUnit::kMetre ? "m" : "mm"));
  about.insertMeta(kVdbDomainKey, openvdb::Vec3IMetadata(openvdb::Vec3i(last.x() + 1, last.y() + 1, last.z() + 1)));
  if (const auto& isovalue = volume.facts().kept_isovalue; isovalue && std::isfinite(*isovalue))
    about.insertMeta(kVdbIsovalueKey, openvdb::DoubleMetadata(*isovalue));
  about.insertMeta(openvdb::GridBase::META_GRID_CREATOR, openvdb::StringMetadata(kVdbCreator));
  about.insertMeta(openvdb::GridBase::META_GRID_NAME, openvdb::StringMetadata("density"));
  openvdb::GridBase::ConstPtr written;
  if (volume.size().unaryExpr([](int n) { return n % kBrickSize; }).isZero() && !volume.facts().is_level_set) {
    written = vdbGridOf(volume)->copyGridReplacingMetadataAndTransform(about, transform);  // the same tree
  } else {
    const ScalarGrid::Ptr grid = vdbGridOf(volume)->deepCopy();
    for (auto entry = about.beginMeta(); entry != about.endMeta(); ++entry) {
      grid->removeMeta(entry->first);
      grid->insertMeta(entry->first, *entry->second);
    }
    grid->setTransform(transform);
    grid->tree().root().setBackground(volume.minimum(), false);
    if (volume.facts().is_level_set)
      makeLevelSet(*grid, std::max(-volume.minimum(), volume.maximum()), units_per_metre);
    grid->clip(openvdb::CoordBBox(openvdb::Coord(0, 0, 0), openvdb::Coord(last.x(), last.y(), last.z())));
    written = grid;
  }
  streamGrid(written, sink);
}

}  // namespace palpate
