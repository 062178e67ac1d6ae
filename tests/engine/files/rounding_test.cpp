// SPDX-License-Identifier: Apache-2.0
// Which numbers of a file no float holds: every reader's count against the numbers themselves, which the tests draw.
// Changes are computed in long double, whose 64 bits hold each of these numbers, each float and their difference.
#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include <fmt/format.h>
#include <openvdb/openvdb.h>

#include "engine/vdb/vdb_grid.hpp"
#include "tests/engine/files/samples.hpp"

namespace palpate {
namespace rounding_test {

// Neither axis a multiple of a brick.
const Vec3i kOdd = {19, 10, 11};

// Of every size that the type has: few bits and many.
template <class T>
std::vector<T> drawn(std::uint32_t seed) {
  std::mt19937_64 random(seed);
  std::vector<T> values(static_cast<std::size_t>(kOdd.prod()));
  for (T& value : values) {
    if constexpr (std::is_integral_v<T>) {
      value = static_cast<T>(static_cast<T>(random()) >> random() % (8 * sizeof(T)));
    } else {
      const double share = static_cast<double>(random() >> 11U) * std::ldexp(1.0, -53);
      const bool few_bits = random() % 3 == 0;
      value =
          static_cast<T>(std::ldexp(few_bits ? std::floor(share * 1024) : share, static_cast<int>(random() % 80) - 40));
    }
  }
  return values;
}

template <class T>
std::string bytes(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

// `exact`: what each voxel's density would be; `first`: where they lie in the volume.
void expectCounted(const Volume& volume, const std::vector<long double>& exact, const std::string& of,
                   const Vec3i& first = Vec3i::Zero()) {
  std::uint64_t count = 0;
  long double most = 0;
  for (int n = 0; n < kOdd.prod(); ++n) {
    const float kept = volume.value(first + Vec3i(n % kOdd.x(), n / kOdd.x() % kOdd.y(), n / kOdd.x() / kOdd.y()));
    const long double number = exact[static_cast<std::size_t>(n)];
    const auto change = [&](float x) { return std::abs(number - static_cast<long double>(x)); };
    for (const float end : {-std::numeric_limits<float>::max(), std::numeric_limits<float>::max()})
      EXPECT_LE(change(kept), change(std::nextafter(kept, end)));  // the nearest float
    count += change(kept) > 0 ? 1 : 0;
    most = std::max(most, change(kept));
  }
  const Rounding& told = volume.facts().rounded;
  EXPECT_EQ(told.count, count);
  EXPECT_EQ(told.most, static_cast<double>(most));
  EXPECT_EQ(told.of, count > 0 ? of : "");
  EXPECT_EQ(volume.facts().rounded.words().find("are no 32-bit floats") != std::string::npos, count > 0);
}

template <class T>
std::vector<long double> asTheyAre(const std::vector<T>& values) {
  return {values.begin(), values.end()};
}

class RoundingOfFiles : public testing::Test {
 protected:
  static std::string nrrd(const std::string& type, const std::string& encoding) {
    return fmt::format(
        "NRRD0004\ntype: {}\ndimension: 3\nsizes: 19 10 11\nspacings: 1 1 1\nencoding: {}\nendian: little\n\n", type,
        encoding);
  }
  static std::string meta(const std::string& type, const std::string& more) {
    return "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nCompressedData = "
           "False\n" +
           more + "DimSize = 19 10 11\nElementSpacing = 1 1 1\nElementType = " + type + "\nElementDataFile = LOCAL\n";
  }
  [[nodiscard]] Volume load(const std::string& name, const std::string& content) const {
    writeFile(folder_.file(name), content);
    return loadVolume(folder_.file(name));
  }
  // Files that state the type alone.
  template <class T>
  void expectPlain(const std::string& name, const std::string& nrrd_name, const std::string& meta_name) const {
    for (std::uint32_t seed = 0; seed < 4; ++seed) {
      SCOPED_TRACE(fmt::format("{} {}", name, seed));
      const std::vector<T> values = drawn<T>(seed);
      const std::vector<long double> exact = asTheyAre(values);
      expectCounted(load("a.nrrd", nrrd(nrrd_name, "raw") + bytes(values)), exact, name);
      writeGzip(folder_.file("data.gz"), bytes(values));
      expectCounted(load("a.nrrd", nrrd(nrrd_name, "gzip") + readFile(folder_.file("data.gz"))), exact, name);
      expectCounted(load("a.mha", meta(meta_name, "") + bytes(values)), exact, name);
    }
  }
  template <class T>
  void expectScaled(const std::string& name, int datatype, const std::string& meta_name) const {
    for (const auto& [slope, intercept] : {std::pair(0.1F, 3.0F), {0.5F, -7.25F}, {-3.0F, 1e-3F}, {1.0F, 0.0F}}) {
      SCOPED_TRACE(fmt::format("{} x {} + {}", name, slope, intercept));
      const std::vector<T> values = drawn<T>(5);
      std::vector<long double> exact;
      for (const T value : values) {
        const auto whole = static_cast<long double>(value);
        const auto product = [&](auto number) -> long double { return number * slope + intercept; };
        exact.push_back(static_cast<double>(value) == whole ? product(static_cast<double>(value)) : product(whole));
      }
      const std::string of = (slope != 1 || intercept != 0 ? "scaled " : "") + name;
      NiftiFields fields;
      fields.dim = {3, 19, 10, 11, 1, 1, 1, 1};
      fields.datatype = datatype;
      fields.bits = 8 * static_cast<int>(sizeof(T));
      fields.slope = slope;
      fields.intercept = intercept;
      expectCounted(load("a.nii", niftiHeader(fields) + bytes(values)), exact, of);
      const std::string scale = fmt::format(
          "ElementToIntensityFunctionSlope = {:.17g}\nElementToIntensityFunctionOffset = {:.17g}\n", slope, intercept);
      expectCounted(load("a.mha", meta(meta_name, scale) + bytes(values)), exact, of);
    }
  }

  TempFolder folder_;
};

TEST_F(RoundingOfFiles, IsCountedForEveryTypeOfNumber) {
  expectPlain<std::uint8_t>("uint8", "uchar", "MET_UCHAR");
  expectPlain<std::int16_t>("int16", "short", "MET_SHORT");
  expectPlain<std::int32_t>("int32", "int", "MET_INT");
  expectPlain<std::uint32_t>("uint32", "uint", "MET_UINT");
  expectPlain<std::int64_t>("int64", "longlong", "MET_LONG_LONG");
  expectPlain<std::uint64_t>("uint64", "ulonglong", "MET_ULONG_LONG");
  expectPlain<float>("float32", "float", "MET_FLOAT");
  expectPlain<double>("float64", "double", "MET_DOUBLE");
}

TEST_F(RoundingOfFiles, IsThatOfTheScaledNumber) {
  expectScaled<std::uint8_t>("uint8", 2, "MET_UCHAR");
  expectScaled<std::int16_t>("int16", 4, "MET_SHORT");
  expectScaled<std::int32_t>("int32", 8, "MET_INT");
  expectScaled<std::int64_t>("int64", 1024, "MET_LONG_LONG");
  expectScaled<float>("float32", 16, "MET_FLOAT");
  expectScaled<double>("float64", 64, "MET_DOUBLE");
}

// 10 x 0.1 is 1 in double, as every program computes it, though the double next to 0.1 is above it. 3 x 0.1 is the
// double 0.30000000000000004. Its nearest float is above it by 1.2e-8: 5033165 x 2^-24.
TEST_F(RoundingOfFiles, IsOfProductsInDouble) {
  std::vector<std::uint8_t> values(static_cast<std::size_t>(kOdd.prod()), 10);
  const std::string header = meta("MET_UCHAR", "ElementToIntensityFunctionSlope = 0.1\n");
  EXPECT_EQ(load("a.mha", header + bytes(values)).facts().rounded.count, 0U);
  values[70] = values[71] = 3;
  const Rounding rounded = load("a.mha", header + bytes(values)).facts().rounded;
  EXPECT_EQ(rounded.count, 2U);
  EXPECT_EQ(rounded.most, 5033165 * std::ldexp(1.0, -24) - 3 * 0.1);
  std::vector<std::int64_t> longs(values.size(), 10);
  const std::string long_header = meta("MET_LONG_LONG", "ElementToIntensityFunctionSlope = 0.1\n");
  EXPECT_EQ(load("a.mha", long_header + bytes(longs)).facts().rounded.count, 0U);
  EXPECT_EQ(rounded.words(), "2 of its scaled uint8 values are no 32-bit floats and were rounded, by 1.19e-08 at most");
}

TEST_F(RoundingOfFiles, IsCountedInProjectsOfInVesalius) {
  const std::vector<double> values = drawn<double>(1);
  const std::string shape = "<integer>11</integer><integer>10</integer><integer>19</integer>";
  writeTarGz(folder_.file("a.inv3"),
             {{"main.plist", invesaliusPlist(shape, "float64")}, {"matrix.dat", bytes(values)}});
  expectCounted(loadVolume(folder_.file("a.inv3")), asTheyAre(values), "float64");
}

// NaN and what no float reaches are told otherwise, and not rounded.
TEST_F(RoundingOfFiles, IsNoneOfWhatIsReplaced) {
  std::vector<double> values(static_cast<std::size_t>(kOdd.prod()), 0.5);
  values[3] = std::numeric_limits<double>::quiet_NaN();
  values[4] = -std::numeric_limits<double>::infinity();
  values[5] = 1e300;
  values[6] = 1.0 / 3;
  writeFile(folder_.file("a.nrrd"), nrrd("double", "raw") + bytes(values));
  const VolumeFacts facts = loadVolume(folder_.file("a.nrrd") + "?nan=7").facts();
  EXPECT_EQ(facts.rounded.count, 1U);
  EXPECT_EQ(facts.replaced, 3U);
}

class RoundingOfGrids : public RoundingOfFiles {
 protected:
  void SetUp() override { openvdb::initialize(); }
  template <class Grid>
  [[nodiscard]] Volume loadGrid(const typename Grid::Ptr& grid) const {
    openvdb::io::File(folder_.file("a.vdb")).write({grid});
    return loadVolume(folder_.file("a.vdb"));
  }
  // Leaves that begin at (3, -2, 5), so that they are no bricks. Around the domain lie two voxels of background.
  template <class Grid>
  [[nodiscard]] typename Grid::Ptr gridOf(const std::vector<typename Grid::ValueType>& values) const {
    auto grid = Grid::create(typename Grid::ValueType(0));
    auto to = grid->getAccessor();
    for (int n = 0; n < kOdd.prod(); ++n)
      to.setValueOn(openvdb::Coord(n % 19 + 3, n / 19 % 10 - 2, n / 190 + 5), values[static_cast<std::size_t>(n)]);
    return grid;
  }
};

TEST_F(RoundingOfGrids, IsCountedForEveryTypeOfNumber) {
  const Vec3i padding = Vec3i::Constant(2);
  const std::vector<double> doubles = drawn<double>(2);
  expectCounted(loadGrid<openvdb::DoubleGrid>(gridOf<openvdb::DoubleGrid>(doubles)), asTheyAre(doubles), "double",
                padding);
  const std::vector<std::int32_t> integers = drawn<std::int32_t>(3);
  expectCounted(loadGrid<openvdb::Int32Grid>(gridOf<openvdb::Int32Grid>(integers)), asTheyAre(integers), "int32",
                padding);
  const std::vector<float> floats = drawn<float>(4);
  expectCounted(loadGrid<openvdb::FloatGrid>(gridOf<openvdb::FloatGrid>(floats)), asTheyAre(floats), "", padding);
}

// A distance in millimetres, in metres and turned round.
TEST_F(RoundingOfGrids, IsThatOfALevelSetsUnit) {
  for (const char* unit : {"m", "mm"}) {
    const std::vector<float> distances = drawn<float>(6);
    const auto grid = gridOf<openvdb::FloatGrid>(distances);
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    grid->insertMeta("unit", openvdb::StringMetadata(unit));
    std::vector<long double> exact;
    for (const float distance : distances)
      exact.push_back(-(unit == std::string("m") ? 1 : 1e-3) * static_cast<double>(distance));
    expectCounted(loadGrid<openvdb::FloatGrid>(grid), exact, "scaled float", Vec3i::Constant(2));
  }
}

// Two tiles of 8 x 8 x 8 voxels, whose numbers have one float, 1, in common with the background. With two voxels of
// that around them the volume's bricks begin two voxels before the tiles, so that some bricks lie across both. No brick
// is stored, and yet each voxel of the tiles counts, and none outside the domain, where bricks end at 20 or 12 voxels.
TEST_F(RoundingOfGrids, OfTilesCountsTheirVoxels) {
  auto grid = openvdb::DoubleGrid::create(1);
  grid->tree().addTile(1, openvdb::Coord(0, 0, 0), 1 + std::ldexp(1.0, -40), true);
  grid->tree().addTile(1, openvdb::Coord(8, 0, 0), 1 + std::ldexp(1.0, -30), true);
  const Volume volume = loadGrid<openvdb::DoubleGrid>(grid);
  EXPECT_EQ(volume.size(), Vec3i(20, 12, 12));
  EXPECT_EQ(volume.storedBricks(), 0U);
  EXPECT_EQ(volume.facts().rounded.count, 2U * 512);
  EXPECT_EQ(volume.facts().rounded.most, std::ldexp(1.0, -30));
}

// --- written --------------------------------------------------------------------------------------------------------

Volume volumeOf(const std::vector<float>& values, const std::string& type, bool is_level_set) {
  VolumeFacts facts;
  facts.source = "test";
  facts.value_type = type;
  facts.is_level_set = is_level_set;
  return Volume::fromDense(kOdd, {Vec3::Zero(), Mat3::Identity(), Vec3::Constant(1e-3)}, values, facts);
}

// Whatever the program can write: floats of any bits, whole numbers that become int16, and level sets, in each format
// and unit. It comes back to the bit unless roundedByWriting() counts something.
TEST(RoundedByWriting, IsNoneWhereEveryBitComesBack) {
  const TempFolder folder;
  int same = 0, rounded_files = 0;
  for (std::uint32_t seed = 0; seed < 6; ++seed) {
    std::mt19937 random(seed);
    std::vector<float> values(static_cast<std::size_t>(kOdd.prod()));
    const bool whole = seed % 3 == 1, is_level_set = seed % 3 == 2;
    for (float& value : values) {
      const auto any = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
      value = whole ? static_cast<float>(static_cast<std::int16_t>(random())) : std::isfinite(any) ? any : -0.0F;
      if (is_level_set) value = std::ldexp(static_cast<float>(random() % (1U << 24U)), -30) - 0.007F;
    }
    const Volume volume = volumeOf(values, whole ? "int32" : "float32", is_level_set);
    const auto roundTrip = [&](const char* name, std::optional<LengthUnit> unit) {
      SCOPED_TRACE(fmt::format("{} {}", name, seed));
      std::string written;
      writeVolume(volume, name, unit, [&](std::string_view piece) { written += piece; });
      writeFile(folder.file(name), written);
      const Rounding rounded = roundedByWriting(volume, name, unit);
      const Volume back = loadVolume(folder.file(name));
      const bool in_mm = std::string(name) == "a.vdb" && unit == LengthUnit::kMillimetre;
      EXPECT_EQ(rounded.count > 0, is_level_set && in_mm);
      ++(rounded.count == 0 ? same : rounded_files);
      if (rounded.count > 0) return;
      EXPECT_EQ(bytes(back.toDense()), bytes(values));
    };
    for (const char* name : {"a.nrrd", "a.nii", "a.nii.gz", "a.mha"}) roundTrip(name, {});
    for (const std::optional<LengthUnit> unit :
         {std::optional<LengthUnit>(), {LengthUnit::kMetre}, {LengthUnit::kMillimetre}})
      roundTrip("a.vdb", unit);
  }
  EXPECT_EQ(rounded_files, 2);
  EXPECT_EQ(same, 6 * 7 - 2);
}

// 0.25 m is 250 mm. 0.3 as a float, 10066330 x 2^-25, times 1000 is 9830400.390625 x 2^-15: to a whole number of these,
// the float next to 300.000012 mm, 0.390625 are lost.
TEST(RoundedByWriting, CountsDistancesInMillimetres) {
  std::vector<float> values(static_cast<std::size_t>(kOdd.prod()), 0.25F);
  values[5] = 0.3F;
  values[900] = -0.3F;
  const Rounding rounded = roundedByWriting(volumeOf(values, "float32", true), "a.vdb", LengthUnit::kMillimetre);
  EXPECT_EQ(rounded.count, 2U);
  EXPECT_EQ(rounded.most, 0.390625 * std::ldexp(1.0, -15));
  EXPECT_EQ(rounded.of, "millimetre");
}

}  // namespace rounding_test
}  // namespace palpate
