// SPDX-License-Identifier: Apache-2.0
// Voxels that are NaN or infinite: refused with their count and place, or made the density that the name asks for.
#include <limits>
#include <random>

#include <fmt/format.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#include "base/crc32c.hpp"
#include "engine/files/vdb_checksum.hpp"
#include "engine/files/volume_file.hpp"
#include "engine/files/volume_name.hpp"
#include "tests/engine/files/samples.hpp"

namespace palpate {
namespace nan_test {

const Vec3i kSize(19, 10, 11);  // bricks that end inside and outside of the domain
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct Damaged {
  std::vector<float> values;
  std::vector<float> mended(float instead) const {
    std::vector<float> all = values;
    for (float& value : all) value = std::isfinite(value) ? value : instead;
    return all;
  }
  long long bad() const {
    return std::count_if(values.begin(), values.end(), [](float value) { return !std::isfinite(value); });
  }
};

// Some, many or whole bricks of them.
Damaged damaged(std::uint32_t seed) {
  std::mt19937 random(seed);
  Damaged image;
  const std::uint32_t one_in = std::vector<std::uint32_t>{2, 20, 700}[seed % 3];
  for (int n = 0; n < kSize.prod(); ++n) {
    const bool in_first_brick = n % 19 < 8 && n / 19 % 10 < 8 && n / 190 < 8;
    const bool bad = random() % one_in == 0 || (seed % 2 == 0 && in_first_brick);
    const float number = static_cast<float>(random() % 1000);
    image.values.push_back(!bad ? number : std::vector<float>{kNan, kInfinity, -kInfinity}[random() % 3]);
  }
  return image;
}

std::string rawFloats(const std::vector<float>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)};
}

class NanVoxels : public testing::Test {
 protected:
  // The image in every format that can hold it.
  std::vector<std::string> write(const std::vector<float>& values) const {
    const std::string raw = rawFloats(values);
    writeFile(folder_.file("a.nrrd"),
              "NRRD0004\ntype: float\ndimension: 3\nsizes: 19 10 11\nspacings: 1 1 1\n"
              "encoding: raw\nendian: little\n\n" +
                  raw);
    writeFile(folder_.file("a.mha"),
              "ObjectType = Image\nNDims = 3\nDimSize = 19 10 11\nElementSpacing = 1 1 1\n"
              "ElementType = MET_FLOAT\nElementDataFile = LOCAL\n" +
                  raw);
    NiftiFields fields;
    fields.dim = {3, 19, 10, 11, 1, 1, 1, 1};
    fields.datatype = 16;
    fields.bits = 32;
    writeFile(folder_.file("a.nii"), niftiHeader(fields) + raw);
    writeGzip(folder_.file("b.nii.gz"), niftiHeader(fields) + raw);
    std::string words;
    for (const float value : values) words += fmt::format("{}\n", value);
    writeFile(folder_.file("b.nrrd"),
              "NRRD0004\ntype: float\ndimension: 3\nsizes: 19 10 11\nspacings: 1 1 1\nencoding: text\n\n" + words);
    const std::string shape = "<integer>11</integer><integer>10</integer><integer>19</integer>";
    writeTarGz(folder_.file("b.inv3"), {{"main.plist", invesaliusPlist(shape, "float32")}, {"matrix.dat", raw}});
    writeVdb(values);
    writeOwnVdb(values);
    return {folder_.file("a.nrrd"),   folder_.file("a.mha"),   folder_.file("a.nii"),
            folder_.file("b.nii.gz"), folder_.file("b.nrrd"),  folder_.file("b.inv3"),
            folder_.file("a.vdb"),    folder_.file("own.vdb"), folder_.file("summed.vdb")};
  }
  // As Palpate saved it: its domain is named, and leaves that lie in it whole are taken over. Then the voxels are put
  // into its leaves. "summed.vdb" has Palpate's checksum as well, which "own.vdb" has lost.
  void writeOwnVdb(const std::vector<float>& values) const {
    const Lattice lattice = {Vec3::Zero(), Mat3::Identity(), Vec3::Constant(1e-3)};
    VolumeFacts facts;
    facts.source = "test";
    std::vector<float> ramp(values.size());
    for (std::size_t n = 0; n < ramp.size(); ++n) ramp[n] = static_cast<float>(n);
    saveVolume(Volume::fromDense(kSize, lattice, ramp, facts), folder_.file("saved.vdb"));
    std::ifstream saved(folder_.file("saved.vdb"), std::ios::binary);
    const auto grids = openvdb::io::Stream(saved, false).getGrids();
    auto to = openvdb::gridPtrCast<openvdb::FloatGrid>(grids->at(0))->getAccessor();
    for (int n = 0; n < kSize.prod(); ++n) {
      to.setValueOn(openvdb::Coord(n % 19, n / 19 % 10, n / 190), values[static_cast<std::size_t>(n)]);
    }
    openvdb::io::File(folder_.file("own.vdb")).write(*grids);
    const std::string bytes = readFile(folder_.file("own.vdb"));
    writeFile(folder_.file("summed.vdb"), bytes + vdbChecksumBytes(crc32c(bytes)));
    ASSERT_EQ(checkVdbChecksum(folder_.file("summed.vdb"), "test"), VdbChecksum::kHolds);
  }
  // As another program writes it: every voxel active.
  void writeVdb(const std::vector<float>& values) const {
    openvdb::initialize();
    const auto grid = openvdb::FloatGrid::create(0.0F);
    auto to = grid->getAccessor();
    for (int n = 0; n < kSize.prod(); ++n) {
      to.setValueOn(openvdb::Coord(n % 19, n / 19 % 10, n / 190), values[static_cast<std::size_t>(n)]);
    }
    openvdb::io::File(folder_.file("a.vdb")).write({grid});
  }
  // A grid of others has two voxels of background around it.
  static std::vector<float> middleOf(const Volume& volume) {
    const Vec3i first = (volume.size() - kSize) / 2;
    std::vector<float> values;
    for (int n = 0; n < kSize.prod(); ++n) values.push_back(volume.value(first + Vec3i(n % 19, n / 19 % 10, n / 190)));
    return values;
  }

  TempFolder folder_;
};

TEST_F(NanVoxels, BecomeTheDensityThatTheNameAsksForInEveryFormat) {
  for (std::uint32_t seed = 0; seed < 12; ++seed) {
    const Damaged image = damaged(seed);
    for (const std::string& file : write(image.values)) {
      for (const float instead : {-1024.0F, 0.0F, 3e38F, 0.1F}) {
        SCOPED_TRACE(testing::Message() << file << " seed " << seed << ", " << instead);
        const std::string name = withNan(file, fmt::format("{}", instead));
        const Volume volume = loadVolume(name);
        ASSERT_EQ(middleOf(volume), image.mended(instead));
        EXPECT_EQ(volume.facts().source, name);
        EXPECT_THAT(volume.facts().remark, testing::HasSubstr(fmt::format("{} of ", image.bad())));
        EXPECT_THAT(volume.facts().remark, testing::HasSubstr(fmt::format("and {} here", instead)));
        EXPECT_EQ(volume.facts().replaced, static_cast<std::uint64_t>(image.bad()));
        EXPECT_FALSE(volume.facts().instead_of_nan);  // or what is computed from it would be mended in silence
      }
    }
  }
}

TEST_F(NanVoxels, AreRefusedWithoutIt) {
  const Damaged image = damaged(2);
  for (const std::string& file : write(image.values)) {
    if (file.find(".nii") != std::string::npos) continue;  // whose are 0
    expectLoadRefusal(file, fmt::format("{} of its ", image.bad()));
    expectLoadRefusal(file, "--nan");
  }
}

TEST_F(NanVoxels, OfWhichAllAreAreRefusedInAnyCase) {
  for (const std::string& file : write(std::vector<float>(static_cast<std::size_t>(kSize.prod()), kNan))) {
    if (file.ends_with("a.vdb")) continue;  // has its background, which is a number
    expectRefusal([&] { static_cast<void>(loadVolume(file + "?nan=0")); }, file, "all of its 2090 voxels are NaN");
  }
}

TEST_F(NanVoxels, NoneOfThemNeedsNoWords) {
  std::vector<float> values(static_cast<std::size_t>(kSize.prod()), 1);
  values[5] = 2;
  for (const std::string& file : write(values)) {
    const Volume volume = loadVolume(file + "?nan=7");
    EXPECT_EQ(middleOf(volume), values);
    EXPECT_EQ(volume.facts().remark, "");
  }
}

// Files of doubles, of which a float cannot hold some.
class BeyondFloat : public testing::Test {
 protected:
  // A ramp of 5 x 4 x 3 voxels with `values` in place of its 7th, 8th, ...
  [[nodiscard]] std::vector<std::string> write(const std::vector<double>& values) const {
    std::vector<double> all = rampValues();
    std::copy(values.begin(), values.end(), all.begin() + 7);
    const std::string raw = bytesOf<double>(all);
    writeFile(folder_.file("a.nrrd"), nrrdHeader("double", "raw") + "\n" + raw);
    writeFile(folder_.file("a.mha"), metaHeader("MET_DOUBLE") + raw);
    writeTarGz(folder_.file("a.inv3"), {{"main.plist", invesaliusPlist(kShape, "float64")}, {"matrix.dat", raw}});
    std::string words;
    for (const double value : all) words += fmt::format("{}\n", value);
    writeFile(folder_.file("words.nrrd"), nrrdHeader("double", "text") + "\n" + words);
    openvdb::initialize();
    const auto grid = openvdb::DoubleGrid::create(0);
    auto to = grid->getAccessor();
    for (int n = 0; n < 60; ++n)
      to.setValueOn(openvdb::Coord(n % 5, n / 5 % 4, n / 20), all[static_cast<std::size_t>(n)]);
    openvdb::io::File(folder_.file("a.vdb")).write({grid});
    return {folder_.file("a.nrrd"), folder_.file("a.mha"), folder_.file("a.inv3"), folder_.file("words.nrrd"),
            folder_.file("a.vdb")};
  }
  static constexpr const char* kShape = "<integer>3</integer><integer>4</integer><integer>5</integer>";
  TempFolder folder_;
};

// The seventh voxel of rows of 5 is (2, 1, 0); in OpenVDB two voxels of background come before it.
TEST_F(BeyondFloat, IsNotCalledInfinite) {
  const std::string beyond = "beyond the range of a float, 3.4e38";
  for (const std::string& file : write({1e300, -1e39})) {
    const bool is_vdb = file.ends_with(".vdb");
    expectLoadRefusal(file, fmt::format("2 of its {} voxels are {}, the first at index ({}); ", is_vdb ? 9 * 8 * 7 : 60,
                                        beyond, is_vdb ? "4, 3, 2" : "2, 1, 0"));
    expectLoadRefusal(file, "say with --nan which density they stand for");
    const Volume volume = loadVolume(file + "?nan=5");
    EXPECT_THAT(volume.facts().remark, testing::HasSubstr("voxels are " + beyond + " in the file, and 5 here"));
    EXPECT_EQ(volume.value(is_vdb ? Vec3i(4, 3, 2) : Vec3i(2, 1, 0)), 5);
    EXPECT_EQ(volume.maximum(), 59);
  }
}

TEST_F(BeyondFloat, IsCountedApartFromWhatIsNoNumber) {
  for (const std::string& file : write({1e300, std::nan(""), -1e300, std::numeric_limits<double>::infinity(), 1e40})) {
    const std::string words = "are no densities (2 NaN or infinite, 3 beyond the range of a float, 3.4e38)";
    expectLoadRefusal(file, words + ", the first at index");
    EXPECT_THAT(loadVolume(file + "?nan=5").facts().remark, testing::HasSubstr(words + " in the file, and 5 here"));
  }
}

// The largest float is (2 - 2^-23) 2^127. What lies below it by half of the last place more is rounded to it.
TEST_F(BeyondFloat, BeginsWhereRoundingLeavesTheFloats) {
  const double limit = std::ldexp(2 - std::ldexp(1, -24), 127);
  for (const std::string& file : write({std::nextafter(limit, 0), -std::nextafter(limit, 0)})) {
    EXPECT_EQ(loadVolume(file).maximum(), std::numeric_limits<float>::max());
    EXPECT_EQ(loadVolume(file).minimum(), -std::numeric_limits<float>::max());
  }
  for (const std::string& file : write({limit})) expectLoadRefusal(file, "voxels are beyond the range of a float");
}

// 3e38 is a float, and ten times as much is none. In NIfTI both that and NaN become 0, which the remark tells apart.
TEST_F(BeyondFloat, MayComeFromASlope) {
  std::vector<double> values = rampValues();
  values[0] = 3e38;
  values[1] = std::nan("");
  const std::string raw = bytesOf<float>(values);
  const std::string words =
      "2 of {} voxels are no densities (1 NaN or infinite, 1 beyond the range of a float, 3.4e38)";
  NiftiFields fields;
  fields.datatype = 16;
  fields.bits = 32;
  fields.slope = 10;
  writeFile(folder_.file("a.nii"), niftiHeader(fields) + raw);
  const Volume volume = loadVolume(folder_.file("a.nii"));
  EXPECT_THAT(volume.facts().remark, testing::HasSubstr(fmt::format(fmt::runtime(words), 60)));
  EXPECT_EQ(volume.value({0, 0, 0}), 0);
  EXPECT_EQ(volume.maximum(), 590);
  writeFile(folder_.file("a.mha"),
            metaHeader("MET_FLOAT", "ElementSpacing = 1 1 1\nElementToIntensityFunctionSlope = 10\n") + raw);
  expectLoadRefusal(folder_.file("a.mha"), fmt::format(fmt::runtime(words), "its 60"));
}

// A word that does not fit the type of its file.
TEST_F(BeyondFloat, IsNoWordOfAFloat) {
  std::string words = "1e300\n";
  for (int n = 1; n < 60; ++n) words += "1\n";
  writeFile(folder_.file("a.nrrd"), nrrdHeader("float", "text") + "\n" + words);
  expectLoadRefusal(folder_.file("a.nrrd"), "\"1e300\" among its voxels is beyond the range of their type");
}

// A tile of OpenVDB is one value for many voxels: here of a whole brick.
TEST_F(NanVoxels, OfATileAreCountedEach) {
  openvdb::initialize();
  const auto grid = openvdb::FloatGrid::create(0.0F);
  grid->fill(openvdb::CoordBBox(openvdb::Coord(0), openvdb::Coord(15)), 1.0F);
  grid->tree().addTile(1, openvdb::Coord(8, 0, 0), kNan, true);
  grid->insertMeta("palpate_domain", openvdb::Vec3IMetadata(openvdb::Vec3i(16, 16, 16)));
  openvdb::io::File(folder_.file("tile.vdb")).write({grid});
  expectLoadRefusal(folder_.file("tile.vdb"),
                    "512 of its 4096 voxels are NaN or infinite, the first at index (8, 0, 0)");
}

TEST(VolumeName, NamesFilePartAndDensity) {
  const TempFolder folder;
  const std::string file = folder.file("a.vdb"), strange = folder.file("b#1?nan=2.nrrd");
  writeFile(file, "");
  writeFile(strange, "");
  const auto expectName = [](const std::string& name, const std::string& path, const std::string& part,
                             std::optional<float> nan) {
    SCOPED_TRACE(name);
    const VolumeName parsed = parseVolumeName(name);
    EXPECT_EQ(parsed.path, path);
    EXPECT_EQ(parsed.part, part);
    EXPECT_EQ(parsed.instead_of_nan, nan);
    EXPECT_EQ(parsed.withPart(), name.substr(0, path.size() + (part.empty() ? 0 : part.size() + 1)));
  };
  expectName(file, file, "", {});
  expectName(file + "#two", file, "two", {});
  expectName(file + "?nan=-1024", file, "", -1024.0F);
  expectName(file + "#two?nan=1e3", file, "two", 1e3F);
  expectName(strange, strange, "", {});
  expectName(strange + "?nan=0", strange, "", 0.0F);
  expectName(strange + "#x?nan=0", strange, "x", 0.0F);
  expectName("phantom:knot?size=64&seed=1", "phantom:knot?size=64&seed=1", "", {});
  expectName(folder.path() + "#1.2.3?nan=5", folder.path(), "1.2.3", 5.0F);
}

TEST(VolumeName, RefusesWhatIsNoDensity) {
  for (const std::string text : {"", "x", "nan", "inf", "1e39", "1 ", " 1", "1mm", "0x10", "--1"}) {
    SCOPED_TRACE(text);
    expectRefusal([&] { static_cast<void>(withNan("a.nrrd", text)); }, "--nan", "no density");
    expectRefusal([&] { static_cast<void>(loadVolume("a.nrrd?nan=" + text)); }, "a.nrrd?nan=" + text, "no density");
  }
  expectRefusal([] { static_cast<void>(withNan("a.nrrd?nan=1", "2")); }, "a.nrrd?nan=1", "so does --nan");
  expectRefusal([] { static_cast<void>(withNan("phantom:knot", "2")); }, "phantom:knot", "phantom");
}

// In either order.
TEST(VolumeName, TakesASeriesBesides) {
  const TempFolder folder;
  EXPECT_EQ(withNan(withSeries(folder.path(), "2"), "0"), folder.path() + "#2?nan=0");
  EXPECT_EQ(withSeries(withNan(folder.path(), "0"), "2"), folder.path() + "#2?nan=0");
  expectRefusal([&] { static_cast<void>(withSeries(folder.path() + "#1?nan=0", "2")); }, folder.path() + "#1?nan=0",
                "names a series");
  expectRefusal([&] { static_cast<void>(withSeries(folder.path(), "")); }, "--series", "empty");
}

}  // namespace nan_test
}  // namespace palpate
