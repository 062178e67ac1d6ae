// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <random>

#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <sys/resource.h>

#include "base/crc32c.hpp"
#include "engine/field/statistics.hpp"
#include "engine/files/vdb_checksum.hpp"
#include "engine/files/vdb_claim.hpp"
#include "engine/files/vector_file.hpp"
#include "engine/files/volume_file.hpp"
#include "engine/vdb/vdb_grid.hpp"
#include "tests/engine/files/files.hpp"
#include "tests/engine/files/known_leaks.hpp"

namespace palpate {
namespace vdb_test {

using openvdb::Coord;

class Vdb : public testing::Test {
 protected:
  void SetUp() override { openvdb::initialize(); }

  void write(const openvdb::GridPtrVec& grids) const {
    openvdb::io::File file(path_);
    file.write(grids);
  }

  // The test image at (-3, 5, 100) with values from 1 on, so that none is background.
  template <class Grid>
  static typename Grid::Ptr makeGrid() {
    auto grid = Grid::create(typename Grid::ValueType(0));
    auto values = grid->getAccessor();
    for (int n = 0; n < 60; ++n) {
      values.setValue(Coord(n % 5 - 3, n / 5 % 4 + 5, n / 20 + 100), typename Grid::ValueType(n + 1));
    }
    openvdb::Mat4R matrix = openvdb::Mat4R::identity();
    matrix(0, 0) = 0.5;
    matrix(1, 1) = 0.75;
    matrix(2, 2) = 2.0;
    matrix(3, 0) = 10;
    grid->setTransform(openvdb::math::Transform::createLinearTransform(matrix));
    return grid;
  }

  // Two voxels of background around it on every side.
  static void expectImage(const Volume& volume, double metres_per_unit) {
    EXPECT_EQ(volume.size(), Vec3i(9, 8, 7));
    EXPECT_LE((volume.lattice().spacing_m - kSpacing_mm * metres_per_unit).norm(), 1e-12);
    const Vec3 first(10 + 0.5 * -5, 0.75 * 3, 2.0 * 98);
    EXPECT_LE((volume.lattice().origin_W - first * metres_per_unit).norm(), 1e-9);
    for (int n = 0; n < 9 * 8 * 7; ++n) {
      const Vec3i index(n % 9, n / 9 % 8, n / 72);
      const Vec3i inner = index - Vec3i::Constant(2);
      const bool inside = inner.minCoeff() >= 0 && inner.x() < 5 && inner.y() < 4 && inner.z() < 3;
      const float want = inside ? static_cast<float>((inner.z() * 4 + inner.y()) * 5 + inner.x() + 1) : 0.0F;
      ASSERT_EQ(volume.value(index), want) << index.transpose();
    }
  }

  TempFolder folder_;
  std::string path_ = folder_.file("a.vdb");
};

TEST_F(Vdb, ReadsFloatHalfDoubleAndIntegerGrids) {
  write({makeGrid<openvdb::FloatGrid>()});
  expectImage(loadVolume(path_), 1);
  EXPECT_EQ(loadVolume(path_).facts().value_type, "float");
  const auto half = makeGrid<openvdb::FloatGrid>();
  half->setSaveFloatAsHalf(true);
  write({half});
  expectImage(loadVolume(path_), 1);  // whole numbers below 2048 are exact in half
  EXPECT_EQ(loadVolume(path_).facts().value_type, "half");
  write({makeGrid<openvdb::DoubleGrid>()});
  expectImage(loadVolume(path_), 1);
  write({makeGrid<openvdb::Int32Grid>()});
  expectImage(loadVolume(path_), 1);
}

TEST_F(Vdb, TakesTheUnitFromTheMetadata) {
  const auto grid = makeGrid<openvdb::FloatGrid>();
  grid->insertMeta("unit", openvdb::StringMetadata("mm"));
  write({grid});
  expectImage(loadVolume(path_), 1e-3);
  for (const auto& [unit, metres] : {std::pair("um", 1e-6), std::pair("cm", 1e-2), std::pair("m", 1.0)}) {
    grid->insertMeta("unit", openvdb::StringMetadata(unit));
    write({grid});
    expectImage(loadVolume(path_), metres);
  }
  grid->insertMeta("unit", openvdb::StringMetadata("ell"));
  write({grid});
  expectLoadRefusal(path_, "its unit of length \"ell\" is not known; use m, cm, mm or um");
}

// A domain that is none, or that active voxels lie outside of, is the active voxels' own.
TEST_F(Vdb, TakesANamedDomainOnlyWhereItCanBe) {
  const auto sizeWith = [&](const openvdb::Vec3i& named, const Coord& last) {
    const auto grid = openvdb::FloatGrid::create(0);
    for (const Coord& voxel : {Coord(0), last}) grid->tree().setValueOn(voxel, 1);
    grid->insertMeta(kVdbDomainKey, openvdb::Vec3IMetadata(named));
    write({grid});
    return loadVolume(path_).size();
  };
  const Coord last(9, 10, 11);
  const Vec3i active(14, 15, 16);  // two voxels around 10 x 11 x 12
  EXPECT_EQ(sizeWith({10, 11, 12}, last), Vec3i(10, 11, 12));
  EXPECT_EQ(sizeWith({10, 20, 12}, last), Vec3i(10, 20, 12));
  EXPECT_EQ(sizeWith({16384, 11, 12}, last), Vec3i(16384, 11, 12));
  EXPECT_EQ(sizeWith({16385, 11, 12}, last), active);
  EXPECT_EQ(sizeWith({9, 11, 12}, last), active);
  EXPECT_EQ(sizeWith({10, 10, 12}, last), active);
  EXPECT_EQ(sizeWith({10, 11, 11}, last), active);
  EXPECT_EQ(sizeWith({10, 11, 0}, last), active);
  EXPECT_EQ(sizeWith({1, 1, 1}, Coord(0)), Vec3i(1, 1, 1));
}

// With the two voxels around them, active voxels may span as many as an axis may have.
TEST_F(Vdb, HoldsTheLongestAxis) {
  const auto grid = openvdb::FloatGrid::create(0);
  grid->tree().setValueOn(Coord(0), 1);
  grid->tree().setValueOn(Coord(0, 16379, 0), 1);
  write({grid});
  EXPECT_EQ(loadVolume(path_).size(), Vec3i(5, 16384, 5));
  grid->tree().setValueOn(Coord(0, 16380, 0), 1);
  write({grid});
  expectLoadRefusal(path_, "its active voxels span 16381 along an axis, and 16384 are the most");
}

TEST_F(Vdb, ChoosesAGridByName) {
  const auto mask = openvdb::BoolGrid::create();
  mask->setName("mask");
  const auto first = openvdb::FloatGrid::create();
  first->setName("first");
  first->getAccessor().setValue(Coord(0, 0, 0), 7);
  const auto second = makeGrid<openvdb::FloatGrid>();
  second->setName("second");
  write({mask, first, second});
  EXPECT_EQ(loadVolume(path_).maximum(), 7);
  expectImage(loadVolume(path_ + "#second"), 1);
  expectLoadRefusal(path_ + "#third", "\"second\" (float)");
  expectLoadRefusal(path_ + "#mask", "no grid of numbers named");
  write({mask});
  expectLoadRefusal(path_, "only \"mask\" (bool)");
}

TEST_F(Vdb, SaysThatAGridHoldsVectors) {
  const auto vectors = openvdb::Vec3DGrid::create();
  vectors->setName("flow");
  vectors->getAccessor().setValue(Coord(0, 0, 0), openvdb::Vec3d(1, 2, 3));
  write({vectors});
  const std::string words = "the voxels of its grid \"flow\" are vectors of 3 components, and a density is one number";
  expectLoadRefusal(path_, words);
  expectLoadRefusal(path_ + "#flow", words);
  expectLoadRefusal(path_ + "#other", "there are \"flow\" (vec3d)");
  const auto density = makeGrid<openvdb::FloatGrid>();
  density->setName("density");
  write({vectors, density});
  expectImage(loadVolume(path_), 1);
  expectLoadRefusal(path_ + "#flow", words);
  const auto mask = openvdb::BoolGrid::create();
  write({vectors, mask});
  expectLoadRefusal(path_, "only \"flow\" (vec3d), \"\" (bool)");
}

// Two bricks wide of 2 x 3 x 1.5 mm; the first has 8 x 5 x 4 voxels in the domain.
TEST_F(Vdb, SaysWhatAFileOfGradientsIs) {
  const Lattice lattice = {Vec3(0.01, 0, 0), Mat3::Identity(), Vec3(2e-3, 3e-3, 1.5e-3)};
  const std::unique_ptr<VectorFile> gradients = makeVectorFile(Vec3i(10, 5, 4), lattice, "test");
  gradients->setBrick(Vec3i(0, 0, 0), std::vector<Eigen::Vector3f>(kBrickVoxels, Eigen::Vector3f(1, 2, 3)));
  std::string bytes;
  gradients->write([&](std::string_view piece) { bytes += piece; });
  writeFile(path_, bytes);
  const std::string words =
      "it holds the gradients of a volume, which palpate gradient wrote: "
      "in the grid \"gradient\" (vec3s) 160 vectors in density/mm, in a box of 10 x 5 x 4 voxels of 2 x 3 x 1.5 mm; "
      "give the volume itself";
  expectLoadRefusal(path_, words);
  expectLoadRefusal(path_ + "#gradient", words);
}

// The level set of a sphere of radius 0.1 m; half width 3 voxels of 5 mm. Interpolated linearly, its distance errs by
// less than h^2 / (2 R) * 3 / 4 = 0.1 mm near the surface.
TEST_F(Vdb, TurnsLevelSetsIntoMinusTheDistance) {
  write({openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(0.1F, openvdb::Vec3f(0.02F, 0, 0), 0.005F, 3.0F)});
  const Volume volume = loadVolume(path_);
  EXPECT_TRUE(volume.facts().is_level_set);
  EXPECT_NEAR(volume.maximum(), 0.015, 1e-6);
  EXPECT_NEAR(volume.minimum(), -0.015, 1e-6);
  double density = 0;
  Vec3 gradient;
  for (const double distance_m : {-0.005, 0.0, 0.005}) {
    ASSERT_TRUE(volume.sample(Vec3(0.02, 0.1 + distance_m, 0), density, gradient));
    EXPECT_NEAR(density, -distance_m, 1e-4);
  }
  EXPECT_LT(volume.storedBricks(), static_cast<std::size_t>(volume.brickCount().prod()));
}

TEST_F(Vdb, ReadsLargeConstantRegionsWithoutStorage) {
  const auto grid = openvdb::FloatGrid::create(0);
  grid->fill(openvdb::CoordBBox(Coord(0), Coord(399)), 5, true);
  write({grid});
  const Volume volume = loadVolume(path_);
  EXPECT_EQ(volume.size(), Vec3i::Constant(404));
  EXPECT_EQ(volume.value({2, 2, 2}), 5);
  EXPECT_EQ(volume.value({1, 2, 2}), 0);
  EXPECT_EQ(volume.value({401, 401, 401}), 5);
  EXPECT_EQ(volume.value({402, 401, 401}), 0);
  const Vec3i n = volume.brickCount();
  const Vec3i inner = n - Vec3i::Constant(2);
  EXPECT_LE(volume.storedBricks(), static_cast<std::size_t>(n.prod() - inner.prod()));
}

TEST_F(Vdb, RefusesShearedAndEmptyGridsAndHugeOnes) {
  const auto grid = makeGrid<openvdb::FloatGrid>();
  openvdb::Mat4R matrix = openvdb::Mat4R::identity();
  matrix(0, 1) = 0.5;
  grid->setTransform(openvdb::math::Transform::createLinearTransform(matrix));
  write({grid});
  expectLoadRefusal(path_, "sheared");
  write({openvdb::FloatGrid::create(1)});
  expectLoadRefusal(path_, "no active voxels");
  const auto far = openvdb::FloatGrid::create(0);
  far->getAccessor().setValue(Coord(0), 1);
  far->getAccessor().setValue(Coord(100000), 1);
  write({far});
  expectLoadRefusal(path_, "100001 along an axis");
}

TEST_F(Vdb, RefusesMoreThanTheBudget) {
  write({makeGrid<openvdb::FloatGrid>()});
  expectRefusal([&] { static_cast<void>(loadVolume(path_, 1000)); }, path_, "GiB", Error::Code::kOutOfMemory);
}

// A file of some hundred KB whose grid takes 40 MiB: with room for the one and not for the other it is refused before
// it is unpacked, whether a checksum vouches for it or not; with room it loads.
TEST_F(Vdb, RefusesMoreThanTheBudgetBeforeItIsUnpacked) {
  const auto grid = openvdb::FloatGrid::create(0);
  for (int leaf = 0; leaf < 20000; ++leaf) {  // packed to next to nothing: leaves of one value
    grid->tree().touchLeaf(Coord(8 * (leaf % 200), 8 * (leaf / 200), 0))->fill(static_cast<float>(leaf % 7) + 1, true);
  }
  write({grid});
  const auto claimed = static_cast<double>(grid->memUsage());
  const std::string other = readFile(path_);
  ASSERT_LT(static_cast<double>(other.size()), 0.1 * claimed);
  EXPECT_NEAR(vdbClaimedBytes(path_, path_), claimed, 0.02 * claimed);
  const std::string own = other + vdbChecksumBytes(crc32c(other));
  for (const std::string& bytes : {other, own}) {
    writeFile(path_, bytes);
    EXPECT_EQ(checkVdbChecksum(path_, path_), bytes == own ? VdbChecksum::kHolds : VdbChecksum::kMissing);
    rusage before{}, after{};
    getrusage(RUSAGE_SELF, &before);
    expectRefusal([&] { static_cast<void>(loadVolume(path_, static_cast<std::size_t>(0.5 * claimed))); }, path_, "GiB",
                  Error::Code::kOutOfMemory);
    getrusage(RUSAGE_SELF, &after);
    EXPECT_LT(static_cast<double>(after.ru_maxrss - before.ru_maxrss) * 1024, 0.5 * claimed);
    EXPECT_EQ(loadVolume(path_).size(), Vec3i(1604, 804, 12));
  }
}

// Grids that are found wherever they lie in a large file, and claims that are none.
TEST_F(Vdb, AddsUpWhatEveryGridClaims) {
  const std::string record("\x0e\0\0\0file_mem_bytes\x05\0\0\0int64\x08\0\0\0", 31);
  const auto claim = [&](std::int64_t bytes) { return record + bytesOf<std::int64_t>({static_cast<double>(bytes)}); };
  std::mt19937 random(3);
  for (int trial = 0; trial < 30; ++trial) {
    std::string bytes;
    double sum = 0;
    for (int n = 0; n < 4; ++n) {
      bytes += std::string(random() % 700000, trial % 2 == 0 ? 'x' : '\x0e');
      const auto one = static_cast<std::int64_t>(random() % 1000);
      bytes += claim(one);
      sum += static_cast<double>(one);
    }
    writeFile(path_, bytes + record.substr(0, random() % record.size()));
    ASSERT_EQ(vdbClaimedBytes(path_, path_), sum) << trial;
  }
  writeFile(path_, claim(-5));
  EXPECT_EQ(vdbClaimedBytes(path_, path_), 0);
  writeFile(path_, "");
  EXPECT_EQ(vdbClaimedBytes(path_, path_), 0);
}

// Cut at 20 places and changed at 40 (tests/damage does more): either a volume or an Error, and no hang.
TEST_F(Vdb, SurvivesDamage) {
  write({openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(0.1F, openvdb::Vec3f(0), 0.01F, 3.0F)});
  const std::string whole = readFile(path_);
  const auto tryLoad = [&](const std::string& bytes) {
    writeFile(path_, bytes);
    try {
      const Volume volume = loadVolume(path_);
      EXPECT_GT(volume.size().minCoeff(), 1);
    } catch (const Error&) {
    }
  };
  for (std::size_t part = 0; part < 20; ++part) {
    writeFile(path_, whole.substr(0, whole.size() * part / 20));
    EXPECT_THROW(static_cast<void>(loadVolume(path_)), Error) << part;
  }
  std::uint64_t random = 1;
  for (int n = 0; n < 40; ++n) {
    random = random * 6364136223846793005U + 1442695040888963407U;
    std::string damaged = whole;
    const std::size_t reach = n % 2 == 0 ? 600 : whole.size();  // half of them in the header
    damaged[(random >> 33) % reach] = static_cast<char>(random >> 20);
    tryLoad(damaged);
  }
}

// A file that Palpate wrote: every changed byte before the checksum is seen, and one that lost it can still be read.
TEST_F(Vdb, OwnFilesHaveAChecksum) {
  std::vector<float> values(4096);
  for (std::size_t n = 0; n < values.size(); ++n) values[n] = static_cast<float>(n * 7919 % 4096);
  saveVolume(Volume::fromDense(Vec3i::Constant(16), plainLattice(), values, {}), path_);
  const std::string whole = readFile(path_);
  EXPECT_EQ(checkVdbChecksum(path_, path_), VdbChecksum::kHolds);
  for (std::size_t at = 20; at + 16 < whole.size(); at += 97) {  // the first bytes say what the file is
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 4);
    writeFile(path_, damaged);
    expectLoadRefusal(path_, "checksum");
  }
  writeFile(path_, whole.substr(0, whole.size() - 16));
  EXPECT_EQ(checkVdbChecksum(path_, path_), VdbChecksum::kMissing);
  EXPECT_EQ(loadVolume(path_).toDense(), values);
  openvdb::io::File other(path_);  // another program
  writeFile(path_, whole);
  other.open();
  EXPECT_EQ(other.getGrids()->size(), 1U);
}

// Lengths of packed values made negative or huge: OpenVDB would write beyond its buffer, or ask for all memory.
TEST_F(Vdb, RefusesLengthsThatCannotBe) {
  const auto grid = makeGrid<openvdb::FloatGrid>();
  write({grid});
  const std::string whole = readFile(path_);
  int refused = 0;
  for (std::size_t at = whole.size() - 400; at + 8 <= whole.size(); ++at) {
    for (const std::int64_t length : {std::int64_t{-100'000}, std::int64_t{1} << 32}) {
      if (at % 7 != 0) continue;
      std::string damaged = whole;
      std::memcpy(damaged.data() + at, &length, sizeof length);
      writeFile(path_, damaged);
      try {
        EXPECT_GT(loadVolume(path_).size().minCoeff(), 0);
      } catch (const Error&) {
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 10);
}

// OpenVDB reads such a transform, and throws when it is used.
TEST_F(Vdb, RefusesATransformThatIsDamaged) {
  write({makeGrid<openvdb::FloatGrid>()});
  const std::string whole = readFile(path_);
  int refused = 0;
  for (const double damaged : {0.0, std::nan(""), 1e300}) {
    const std::string scale = bytesOf<double>({0.75});
    for (std::size_t at = whole.find(scale); at != std::string::npos; at = whole.find(scale, at + 1)) {
      std::string bytes = whole;
      bytes.replace(at, scale.size(), bytesOf<double>({damaged}));
      writeFile(path_, bytes);
      try {
        EXPECT_GT(loadVolume(path_).size().minCoeff(), 0);
      } catch (const Error& error) {
        EXPECT_THAT(error.what(), testing::StartsWith(path_));
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 0);
}

// Written as it lies in memory, from a copy, and as a level set; a copy of the file keeps it, and a file in which
// nobody sculpted has none.
TEST_F(Vdb, KeepsTheIsovalue) {
  for (const int edge : {8, 9}) {
    for (const bool is_level_set : {false, true}) {
      std::vector<float> values(static_cast<std::size_t>(edge * edge * edge));
      for (std::size_t n = 0; n < values.size(); ++n) values[n] = static_cast<float>(n) - 20;
      VolumeFacts facts;
      facts.is_level_set = is_level_set;
      Volume volume = Volume::fromDense(Vec3i::Constant(edge), plainLattice(), values, facts);
      saveVolume(volume, path_);
      EXPECT_FALSE(loadVolume(path_).facts().kept_isovalue);
      volume.keepIsovalue(100 / 3.0);
      saveVolume(volume, path_);
      EXPECT_EQ(loadVolume(path_).facts().kept_isovalue, 100 / 3.0) << edge << is_level_set;
      saveVolume(loadVolume(path_), folder_.file("copy.vdb"));
      EXPECT_EQ(defaultIsovalue(loadVolume(folder_.file("copy.vdb"))), 100 / 3.0);
      saveVolume(volume, folder_.file("a.nrrd"));
      EXPECT_FALSE(loadVolume(folder_.file("a.nrrd")).facts().kept_isovalue);
    }
  }
}

// The volume can be loaded, and written again without it, but whoever needs an isovalue is told.
TEST_F(Vdb, TellsOfADamagedIsovalue) {
  const double infinity = std::numeric_limits<double>::infinity();
  for (const openvdb::Metadata::Ptr& damaged :
       {openvdb::DoubleMetadata(std::nan("")).copy(), openvdb::DoubleMetadata(-infinity).copy(),
        openvdb::DoubleMetadata(infinity).copy(), openvdb::StringMetadata("12").copy()}) {
    const auto grid = makeGrid<openvdb::FloatGrid>();
    grid->insertMeta(kVdbIsovalueKey, *damaged);
    write({grid});
    const Volume volume = loadVolume(path_);
    expectRefusal([&] { static_cast<void>(defaultIsovalue(volume)); }, path_, "that it keeps is outside its values");
    EXPECT_NO_THROW(checkIsovalue(volume, 10));
    saveVolume(volume, folder_.file("copy.vdb"));
    EXPECT_FALSE(loadVolume(folder_.file("copy.vdb")).facts().kept_isovalue);
  }
}

// What lies beyond the domain belongs to no voxel, so a brick that reaches out of it is of one density if its voxels
// are.
TEST_F(Vdb, BricksAtTheEndOfTheDomainAreConstantToo) {
  const auto grid = openvdb::DoubleGrid::create(-1000);
  for (int n = 0; n < 21 * 21 * 21; ++n) grid->tree().setValueOn(Coord(n % 21, n / 21 % 21, n / 441), 200);
  grid->tree().setValueOn(Coord(0, 0, 0), -1000);
  grid->insertMeta("palpate_domain", openvdb::Vec3IMetadata(openvdb::Vec3i(21, 21, 21)));
  write({grid});
  const Volume volume = loadVolume(path_);
  EXPECT_EQ(volume.size(), Vec3i::Constant(21));
  EXPECT_EQ(volume.value(Vec3i::Constant(20)), 200);
  EXPECT_EQ(volume.storedBricks(), 1U);  // the one at the origin
}

// Other programs see air around the volume: near it, where its nodes reach beyond it, and far away; nothing there is
// active. 24 voxels are whole bricks, 21 are not.
TEST_F(Vdb, OutsideTheDomainIsBackground) {
  for (const int edge : {24, 21}) {
    const TempFolder folder;
    std::vector<float> values(static_cast<std::size_t>(edge * edge * edge), -1000.0F);
    for (std::size_t n = 0; n < values.size(); n += 3) values[n] = 200.0F;
    const Volume volume = Volume::fromDense(Vec3i::Constant(edge), Lattice{}, values, {});
    saveVolume(volume, folder.file("a.vdb"));
    openvdb::io::File file(folder.file("a.vdb"));
    file.open();
    const auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("density"));
    EXPECT_EQ(grid->background(), -1000.0F);
    EXPECT_EQ(grid->getCreator(), "Palpate");
    for (const openvdb::Coord& outside :
         {openvdb::Coord(-1, 0, 0), openvdb::Coord(edge, 0, 0), openvdb::Coord(0, 40, 0), openvdb::Coord(0, 0, 500),
          openvdb::Coord(5000, 0, 0)}) {
      EXPECT_EQ(grid->tree().getValue(outside), -1000.0F) << edge << " " << outside;
      EXPECT_FALSE(grid->tree().isValueOn(outside));
    }
    EXPECT_EQ(grid->evalActiveVoxelBoundingBox().dim(), openvdb::Coord(edge, edge, edge));
  }
}

}  // namespace vdb_test
}  // namespace palpate
