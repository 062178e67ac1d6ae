// SPDX-License-Identifier: Apache-2.0
// OpenVDB files: the first float, half, double or integer grid, or the one that "file.vdb#name" names.
//
// The domain is the one that the metadata "palpate_domain" names. Without it, the domain is the box of active voxels,
// padded by two voxels on every side; the padding holds what the grid has there, mostly background. Lengths are metres
// unless the grid's or the file's metadata "unit" says mm, um or cm. A level set becomes density = -distance [m], so
// that density above 0 is inside. World axes are taken as LPS.
//
// A leaf that is a brick of the volume is taken over: its memory becomes the volume's. In a file that Palpate wrote
// these are all leaves but those at the border. The other leaves are copied.
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <type_traits>

#include <fmt/format.h>
#include <malloc.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#include "base/child_process.hpp"
#include "base/error.hpp"
#include "base/units.hpp"
#include "engine/field/brick_values.hpp"
#include "engine/field/memory_budget.hpp"
#include "engine/field/raw_values.hpp"
#include "engine/files/components.hpp"
#include "engine/files/quiet.hpp"
#include "engine/files/text_header.hpp"
#include "engine/files/vdb_checksum.hpp"
#include "engine/files/vdb_claim.hpp"
#include "engine/files/volume_name.hpp"
#include "engine/vdb/vdb_grid.hpp"
#include "engine/vdb/vdb_parts.hpp"

namespace palpate {
namespace {

constexpr int kPadding = 2;  // [voxel]

// Reads every grid. Unlike io::File, a stream can be told to throw at its end. So a header with a false count cannot
// keep the reader busy with bytes that do not exist.
openvdb::GridPtrVecPtr readGrids(const std::string& path, const std::string& source) {
  const Quiet quiet;
  openvdb::initialize();
  std::ifstream file(path, std::ios::binary);
  if (!file) throw cannotRead(source, "it", {errno, std::generic_category()});
  file.exceptions(std::ios::failbit | std::ios::badbit);
  try {
    openvdb::io::Stream stream(file, false);
    return stream.getGrids();
  } catch (const std::bad_alloc&) {
    refuse(source, "it asks for more memory than there is", "the file may be damaged: copy or write it again");
  } catch (const std::exception&) {
    refuse(source, "it is no OpenVDB file, or it is cut short or damaged", "copy or write it again");
  }
}

// A damaged length in the file makes OpenVDB write beyond a buffer. So it may read a file in this process only if a
// checksum holds, or if a child process has read the whole file without harm. Damage that corrupts memory is noticed
// there, at the latest when sizes do not match.
void tryToRead(const std::string& path, const std::string& source, double claimed_bytes) {
  constexpr double kMostInMemory = 64;  // bytes in memory for each byte in the file, if the file does not say
  const auto bytes = static_cast<double>(fileBytes(path, source));
  const double memory =
      std::min(std::max(kMostInMemory * bytes, 1.5 * claimed_bytes), static_cast<double>(availableMemoryBytes()));
  const ChildOutcome trial = runInChild(source, 1, limitsForFile(bytes, memory), [&](std::size_t) {
    new openvdb::GridPtrVecPtr(readGrids(path, source));  // not freed: the process ends
    return std::string();
  });
  if (!trial.trouble) return;
  if (trial.trouble->error) throw Error(*trial.trouble->error);
  refuse(source, fmt::format("it is damaged ({})", trial.trouble->words), "copy or write it again");
}

bool isScalar(const openvdb::GridBase& grid) {
  return grid.isType<openvdb::FloatGrid>() || grid.isType<openvdb::DoubleGrid>() || grid.isType<openvdb::Int32Grid>();
}

bool isVectors(const openvdb::GridBase& grid) {
  return grid.valueType().starts_with("vec");
}

// Whether VectorFile wrote the grid.
bool isGradient(const openvdb::GridBase& grid) {
  const auto unit = grid.getMetadata<openvdb::StringMetadata>(kVdbVectorUnitKey);
  return isVectors(grid) && unit && grid.getCreator() == kVdbCreator;
}

// "41 x 33 x 37 voxels of 0.5 x 0.5 x 0.8 mm", as far as the metadata tell.
std::string extentWords(const openvdb::GridBase& grid) {
  std::string words;
  if (const auto size = grid.getMetadata<openvdb::Vec3IMetadata>(kVdbDomainKey)) {
    words = fmt::format("{} x {} x {} ", size->value().x(), size->value().y(), size->value().z());
  }
  const openvdb::Vec3d voxel = grid.transform().voxelSize();
  const auto unit = grid.getMetadata<openvdb::StringMetadata>("unit");
  return words + fmt::format("voxels of {:.6g} x {:.6g} x {:.6g} {}", voxel.x(), voxel.y(), voxel.z(),
                             unit ? unit->value() : "m");
}

// A grid that the user means, and that holds vectors.
[[noreturn]] void refuseVectors(const openvdb::GridBase& grid, const std::string& source) {
  if (!isGradient(grid)) {
    refuseComponents(source, Components::kVectors, 3, fmt::format("the voxels of its grid \"{}\"", grid.getName()));
  }
  refuse(source,
         fmt::format("it holds the gradients of a volume, which palpate gradient wrote: "
                     "in the grid \"{}\" ({}) {} vectors in {}, in a box of {}",
                     grid.getName(), grid.valueType(), grid.activeVoxelCount(),
                     grid.getMetadata<openvdb::StringMetadata>(kVdbVectorUnitKey)->value(), extentWords(grid)),
         "give the volume itself; gradients are for other programs");
}

openvdb::GridBase& chooseGrid(const openvdb::GridPtrVec& grids, const std::string& wanted, const std::string& source) {
  std::string names;
  const openvdb::GridBase* vectors = nullptr;  // the grid that the user means, if it holds vectors
  for (const auto& grid : grids) {
    if (isScalar(*grid) && (wanted.empty() || grid->getName() == wanted)) return *grid;
    const bool is_meant = wanted.empty() ? grids.size() == 1 : grid->getName() == wanted;
    if (is_meant && isVectors(*grid)) vectors = grid.get();
    names += fmt::format("{}\"{}\" ({})", names.empty() ? "" : ", ", grid->getName(), grid->valueType());
  }
  if (vectors != nullptr) refuseVectors(*vectors, source);
  if (names.empty()) refuse(source, "it has no grids", "write the file again");
  if (wanted.empty()) refuse(source, "it has no grid of numbers, only " + names, "give a density or a level set");
  refuse(source, fmt::format("it has no grid of numbers named \"{}\"; there are {}", wanted, names),
         "name one of them");
}

double metresPerUnit(const openvdb::GridBase& grid, const std::string& source) {
  const auto unit = grid.getMetadata<openvdb::StringMetadata>("unit");
  if (!unit || unit->value() == "m") return 1;
  if (unit->value() == "mm") return kMetresPerMillimetre;
  if (unit->value() == "cm") return 1e-2;
  if (unit->value() == "um") return 1e-6;
  refuse(source, fmt::format("its unit of length \"{}\" is not known", unit->value()), "use m, cm, mm or um");
}

// The lattice whose voxel (0,0,0) is the grid's voxel `first`. VDB multiplies row vectors: rows 0 to 2 are the axes.
Lattice latticeOf(const openvdb::GridBase& grid, const openvdb::Coord& first, const std::string& source) {
  if (!grid.transform().isLinear())
    refuse(source, "its transform is not linear", "resample the volume onto a regular grid");
  const openvdb::Mat4R matrix = grid.transform().baseMap()->getAffineMap()->getMat4();
  const double metres = metresPerUnit(grid, source);
  const openvdb::Vec3d origin = grid.transform().indexToWorld(first);
  Lattice lattice;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 step = Vec3(matrix(axis, 0), matrix(axis, 1), matrix(axis, 2)) * metres;
    lattice.spacing_m[axis] = step.norm();
    lattice.R_WL.col(axis) = step / step.norm();
    lattice.origin_W[axis] = origin[axis] * metres;
  }
  return orthonormalised(lattice, source);
}

// The domain that a file by Palpate names; empty if it names none, or if active voxels lie outside it.
std::optional<openvdb::CoordBBox> namedDomain(const openvdb::GridBase& grid) {
  const auto size = grid.getMetadata<openvdb::Vec3IMetadata>(kVdbDomainKey);
  if (!size) return {};
  const openvdb::Vec3i n = size->value();
  for (int axis = 0; axis < 3; ++axis) {
    if (n[axis] < 1 || n[axis] > kMaxDimension) return {};
  }
  const openvdb::CoordBBox domain(openvdb::Coord(0, 0, 0), openvdb::Coord(n[0] - 1, n[1] - 1, n[2] - 1));
  const openvdb::CoordBBox active = grid.evalActiveVoxelBoundingBox();
  if (!active.empty() && !domain.isInside(active)) return {};
  return domain;
}

// The isovalue in the metadata; empty without the key, NaN if its value is not a double.
std::optional<double> keptIsovalue(const openvdb::GridBase& grid) {
  if (!grid[kVdbIsovalueKey]) return {};
  const auto kept = grid.getMetadata<openvdb::DoubleMetadata>(kVdbIsovalueKey);
  return kept ? kept->value() : std::numeric_limits<double>::quiet_NaN();
}

openvdb::CoordBBox domainOf(const openvdb::GridBase& grid, const std::string& source) {
  if (const auto named = namedDomain(grid)) return *named;
  openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
  if (box.empty())
    refuse(source, fmt::format("its grid \"{}\" has no active voxels", grid.getName()), "give another grid");
  for (int axis = 0; axis < 3; ++axis) {
    const double length = static_cast<double>(box.max()[axis]) - static_cast<double>(box.min()[axis]);
    if (length < kMaxDimension - std::int64_t{2} * kPadding && std::abs(static_cast<double>(box.min()[axis])) < 1e9)
      continue;
    refuse(source,
           fmt::format("its active voxels span {:.0f} along an axis, and {} are the most", length + 1, kMaxDimension),
           "crop or resample it");
  }
  box.expand(kPadding);
  return box;
}

// Reads bricks out of a grid of any value type, and counts the values that are rounded, once for each voxel of the
// domain. If no leaf reaches into a brick, only its corners are read. Each layer of bricks has a TreeBricks of its own.
template <class Tree>
class TreeBricks {
 public:
  TreeBricks(const Tree& tree, const openvdb::CoordBBox& domain, double scale, RoundedNumbers& rounded)
      : values_(tree), domain_(domain), scale_(scale), rounded_(rounded) {}

  bool operator()(const Vec3i& brick, float* out) {
    const openvdb::Coord first =
        domain_.min().offsetBy(brick.x() * kBrickSize, brick.y() * kBrickSize, brick.z() * kBrickSize);
    RoundedFew few;
    const bool constant = constantFrom(first, out);
    if (constant) {
      few.add(exactAt(first), out[0]);
      few.count *= insideOf(first);
    } else {
      for (int k = 0; k < kBrickSize; ++k) {
        for (int j = 0; j < kBrickSize; ++j) {
          for (int i = 0; i < kBrickSize; ++i, ++out) {
            const openvdb::Coord voxel = first.offsetBy(i, j, k);
            const double exact = exactAt(voxel);
            *out = floatOf(exact);
            if (domain_.isInside(voxel)) few.add(exact, *out);
          }
        }
      }
    }
    rounded_.add(few);
    return constant;
  }

 private:
  // Voxels outside the domain repeat the nearest one inside.
  double exactAt(openvdb::Coord voxel) const {
    voxel.minComponent(domain_.max());
    return scale_ * static_cast<double>(values_.getValue(voxel));
  }

  // Voxels of the brick from `first` on that lie in the domain.
  std::uint64_t insideOf(const openvdb::Coord& first) const {
    openvdb::CoordBBox box(first, first.offsetBy(kBrickSize - 1));
    box.intersect(domain_);
    return box.volume();
  }

  // A brick overlaps at most two leaf cells along each axis. Its corners lie in all the leaf cells that it overlaps.
  // Numbers that only their floats have in common are counted one by one.
  bool constantFrom(const openvdb::Coord& first, float* out) const {
    const double exact = exactAt(first);
    out[0] = floatOf(exact);
    for (int corner = 0; corner < 8; ++corner) {
      const int last = kBrickSize - 1;
      const openvdb::Coord voxel =
          first.offsetBy((corner & 1) * last, (corner >> 1 & 1) * last, (corner >> 2 & 1) * last);
      const double value = exactAt(voxel);
      if (values_.probeConstLeaf(voxel) != nullptr || value != exact || !sameBits(floatOf(value), out[0])) return false;
    }
    return true;
  }

  openvdb::tree::ValueAccessor<const Tree, false> values_;  // not registered with the tree, which does not change
  openvdb::CoordBBox domain_;
  double scale_;
  RoundedNumbers& rounded_;
};

// Whether the file's leaves are aligned with the volume's bricks and hold the same values.
bool leavesAreBricks(const openvdb::GridBase& grid, const openvdb::CoordBBox& domain, double scale) {
  const openvdb::Coord& first = domain.min();
  const bool is_aligned = ((first.x() | first.y() | first.z()) & (kBrickSize - 1)) == 0;
  return grid.isType<ScalarGrid>() && scale == 1 && is_aligned;
}

// The leaves of such a grid as bricks. A leaf that reaches out of the domain is left out.
LeafSource leavesOf(ScalarTree& tree, const openvdb::CoordBBox& domain) {
  return [&tree, domain](const Vec3i& brick) -> ScalarTree::LeafNodeType* {
    const openvdb::Coord first =
        domain.min().offsetBy(brick.x() * kBrickSize, brick.y() * kBrickSize, brick.z() * kBrickSize);
    return domain.isInside(first.offsetBy(kBrickSize - 1)) ? tree.probeLeaf(first) : nullptr;
  };
}

// Leaves of the grid may be empty afterwards.
template <class GridType>
Volume convert(openvdb::GridBase& base, const Lattice& lattice, const openvdb::CoordBBox& domain, double scale,
               VolumeFacts facts) {
  auto& tree = static_cast<GridType&>(base).tree();
  const openvdb::Coord dim = domain.dim();
  LeafSource leaf_of;
  if constexpr (std::is_same_v<GridType, ScalarGrid>) {
    if (leavesAreBricks(base, domain, scale)) leaf_of = leavesOf(tree, domain);
  }
  using Bricks = TreeBricks<typename GridType::TreeType>;
  RoundedNumbers rounded;
  const std::string type = facts.value_type;
  Volume volume(buildGridByLayers(
      Vec3i(dim.x(), dim.y(), dim.z()), lattice, std::move(facts),
      [&](int) { return Bricks(tree, domain, scale, rounded); }, leaf_of));
  volume.noteRounding(rounded.of(type, scale != 1));
  return volume;
}

// Counts the leaves, their copy on the GPU, and a tile for every brick of the domain. Leaves that are taken over have
// their memory already, so they do not count against free memory. Other leaves are copied while the file's own still
// exist.
void checkSparseMemory(const openvdb::GridBase& grid, const openvdb::CoordBBox& domain, double scale,
                       const std::string& source, std::size_t memory_budget_bytes) {
  constexpr double kTileBytes = 8;
  const openvdb::Coord dim = domain.dim();
  const double box = static_cast<double>(dim.x()) * static_cast<double>(dim.y()) * static_cast<double>(dim.z());
  checkBricks(source, dim.x(), dim.y(), dim.z());
  const auto leaves = static_cast<double>(grid.memUsage());
  const bool free_only = memory_budget_bytes == 0 && leavesAreBricks(grid, domain, scale);
  checkMemory(
      source,
      leaves * ((free_only ? 0 : 1) + kGpuBytesPerVoxel / kDenseBytesPerVoxel) + box / kBrickVoxels * kTileBytes,
      memory_budget_bytes);
}

Volume readGrid(const ReadRequest& wanted) {
  const std::string& name = wanted.name;
  const VolumeName parsed = parseVolumeName(name);
  const std::string& path = parsed.path;
  const VdbChecksum checksum = checkVdbChecksum(path, name);
  if (checksum == VdbChecksum::kFails)
    refuse(name, "its checksum is not that of its bytes: it is damaged", "copy or write it again");
  const double claimed_bytes = vdbClaimedBytes(path, name);
  checkMemory(name, std::max(claimed_bytes, static_cast<double>(fileBytes(path, name))), wanted.memory_budget_bytes);
  if (checksum == VdbChecksum::kMissing) tryToRead(path, name, claimed_bytes);
  const openvdb::GridPtrVecPtr grids = readGrids(path, name);
  openvdb::GridBase& grid = chooseGrid(*grids, parsed.part, name);
  const openvdb::CoordBBox domain = domainOf(grid, name);
  const Lattice lattice = latticeOf(grid, domain.min(), name);
  VolumeFacts facts;
  facts.source = name;
  facts.instead_of_nan = wanted.instead_of_nan;
  facts.format = "OpenVDB";
  facts.value_type = grid.saveFloatAsHalf() ? "half" : grid.valueType();
  facts.orientation = "world axes taken as LPS";
  facts.is_level_set = grid.getGridClass() == openvdb::GRID_LEVEL_SET;
  facts.kept_isovalue = keptIsovalue(grid);
  const double scale = facts.is_level_set ? -metresPerUnit(grid, name) : 1;
  checkSparseMemory(grid, domain, scale, name, wanted.memory_budget_bytes);
  if (grid.isType<openvdb::FloatGrid>())
    return convert<openvdb::FloatGrid>(grid, lattice, domain, scale, std::move(facts));
  if (grid.isType<openvdb::DoubleGrid>())
    return convert<openvdb::DoubleGrid>(grid, lattice, domain, scale, std::move(facts));
  return convert<openvdb::Int32Grid>(grid, lattice, domain, scale, std::move(facts));
}

// OpenVDB checks a transform only when it is used, not when it is read. So openvdb::Exception is caught here.
Volume readOrRefuse(const ReadRequest& wanted) {
  try {
    return readGrid(wanted);
  } catch (const openvdb::Exception& failure) {
    refuse(wanted.name, fmt::format("it is damaged ({})", shortReason(failure.what())), "copy or write it again");
  }
}

}  // namespace

Volume readVdbVolume(const ReadRequest& wanted) {
  Volume volume = readOrRefuse(wanted);
  // The file's own grid is freed: leaves that were copied, 2 KiB each, and nodes of those that were taken over. They
  // lie in the middle of the heap, so the system gets their memory back only on request.
  malloc_trim(0);
  return volume;
}

std::size_t readWithOpenVdbAlone(const std::string& name) {
  try {
    openvdb::initialize();
    openvdb::io::File file(name);
    file.open(false);  // nothing is left for later
    openvdb::Index64 bytes = 0;
    const openvdb::GridPtrVecPtr grids = file.getGrids();
    for (const openvdb::GridBase::Ptr& grid : *grids) bytes += grid->memUsage();
    return bytes;
  } catch (const openvdb::Exception& failure) {
    throw Error(Error::Code::kBadInput, name, shortReason(failure.what()), "give another file");
  }
}

}  // namespace palpate
