// SPDX-License-Identifier: Apache-2.0
// Writes one OpenVDB grid of floats: a density, or a level set where the volume came from one.
//
// Leaves stay where they are; constant bricks are tiles. Outside the domain there is background: the lowest density, or
// the level set's largest distance. A density whose domain ends with its bricks is written as it lies in memory,
// without a copy; edits that went lower than any density before do not change its background.
#include <cmath>
#include <ostream>
#include <streambuf>

#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#include "base/error.hpp"
#include "base/units.hpp"
#include "engine/volume/grid.hpp"
#include "engine/volume/quiet.hpp"
#include "engine/volume/writers.hpp"

namespace palpate {
namespace {

class SinkBuffer : public std::streambuf {
 public:
  explicit SinkBuffer(const ByteSink& sink) : sink_(sink) {}

 private:
  std::streamsize xsputn(const char* bytes, std::streamsize count) override {
    sink_({bytes, static_cast<std::size_t>(count)});
    return count;
  }
  int_type overflow(int_type byte) override {
    const char one = traits_type::to_char_type(byte);
    sink_({&one, 1});
    return byte;
  }
  const ByteSink& sink_;
};

// Densities above 0 are inside, distances above 0 outside. What is as far from the surface as anything is no part of
// the narrow band.
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

openvdb::math::Transform::Ptr transformOf(const Lattice& lattice, double units_per_metre, const std::string& name) {
  openvdb::Mat4R matrix = openvdb::Mat4R::identity();  // of row vectors
  for (int axis = 0; axis < 3; ++axis) {
    for (int n = 0; n < 3; ++n) matrix(axis, n) = lattice.R_WL(n, axis) * lattice.spacing_m[axis] * units_per_metre;
    matrix(3, axis) = lattice.origin_W[axis] * units_per_metre;
  }
  try {
    return openvdb::math::Transform::createLinearTransform(matrix);
  } catch (const openvdb::Exception&) {
    throw Error(Error::Code::kBadInput, name, "its voxels are too small for OpenVDB in this unit of length",
                "use --unit mm, or write .nrrd");
  }
}

}  // namespace

void writeVdb(const Volume& volume, const std::string& name, LengthUnit unit, const ByteSink& sink) {
  openvdb::initialize();
  const double units_per_metre = unit == LengthUnit::kMetre ? 1 : kMillimetresPerMetre;
  const auto transform = transformOf(volume.lattice(), units_per_metre, name);
  const Vec3i last = volume.size() - Vec3i::Ones();
  openvdb::MetaMap about;
  about.insertMeta("unit", openvdb::StringMetadata(unit == LengthUnit::kMetre ? "m" : "mm"));
  about.insertMeta(kVdbDomainKey, openvdb::Vec3IMetadata(openvdb::Vec3i(last.x() + 1, last.y() + 1, last.z() + 1)));
  about.insertMeta(openvdb::GridBase::META_GRID_CREATOR, openvdb::StringMetadata("Palpate"));
  about.insertMeta(openvdb::GridBase::META_GRID_NAME, openvdb::StringMetadata("density"));
  openvdb::GridBase::ConstPtr written;
  if (volume.size().unaryExpr([](int n) { return n % kBrickSize; }).isZero() && !volume.facts().is_level_set) {
    written = volume.grid().field->copyGridReplacingMetadataAndTransform(about, transform);  // the same tree
  } else {
    const ScalarGrid::Ptr grid = volume.grid().field->deepCopy();
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
  SinkBuffer buffer(sink);
  std::ostream out(&buffer);
  out.exceptions(std::ios::badbit);  // so that what the sink throws comes through
  const Quiet quiet;
  openvdb::io::Stream(out).write(openvdb::GridCPtrVec{written});
}

}  // namespace palpate
