// SPDX-License-Identifier: Apache-2.0
// What writeVolume writes, loadVolume (for NRRD, NIfTI and MetaImage: ITK) reads back: every density bit for bit, the
// lattice to the rounding of the format's numbers.
#include "engine/files/volume_file.hpp"

#include <bit>
#include <random>

#include <Eigen/Geometry>

#include "engine/files/writers.hpp"
#include "tests/engine/files/files.hpp"

namespace palpate {
namespace volume_file_test {

using ::testing::HasSubstr;

// Anisotropic, turned, 300 mm off, left-handed if asked.
Lattice crooked(bool left_handed) {
  Lattice lattice;
  lattice.origin_W = {-0.1234567, 0.3, 0.0171717};
  lattice.spacing_m = {0.3e-3, 0.7e-3, 1.1e-3};
  lattice.R_WL = (Eigen::AngleAxisd(0.3, Vec3::UnitX()) * Eigen::AngleAxisd(-1.1, Vec3::UnitY()) *
                  Eigen::AngleAxisd(2.5, Vec3::UnitZ()))
                     .toRotationMatrix();
  if (left_handed) lattice.R_WL.col(1) *= -1;
  return lattice;
}

// Odd sizes, a constant part, -0, the smallest and largest numbers.
Volume awkward(const Vec3i& size, const Lattice& lattice, const std::string& type = "float32") {
  std::mt19937 random(7);
  std::vector<float> values(static_cast<std::size_t>(size.prod()));
  for (float& value : values) {
    const auto drawn = static_cast<int>(random() % 65536U) - 32768;
    value = type == "float32" ? std::bit_cast<float>(static_cast<std::uint32_t>(random()) & 0xbfffffffU)
                              : static_cast<float>(drawn);
  }
  if (type == "float32") {
    values[0] = -0.0F;
    values[1] = std::numeric_limits<float>::max();
    values[2] = std::numeric_limits<float>::denorm_min();
  }
  for (int k = 0; k < std::min(8, size.z()); ++k) {
    for (int j = 8; j < std::min(16, size.y()); ++j) {
      std::fill_n(values.begin() + (std::ptrdiff_t{k} * size.y() + j) * size.x(), std::min(8, size.x()), 3.0F);
    }
  }
  VolumeFacts facts;
  facts.source = "test";
  facts.value_type = type;
  return Volume::fromDense(size, lattice, values, facts);
}

void save(const Volume& volume, const std::string& path, std::optional<LengthUnit> unit = {}) {
  std::ofstream file(path, std::ios::binary);
  writeVolume(volume, path, unit,
              [&](std::string_view bytes) { file.write(bytes.data(), static_cast<std::streamsize>(bytes.size())); });
}

void expectSameValues(const Volume& a, const Volume& b) {
  ASSERT_EQ(a.size(), b.size());
  const std::vector<float> x = a.toDense(), y = b.toDense();
  std::size_t differing = 0;
  for (std::size_t n = 0; n < x.size(); ++n) {
    differing += std::bit_cast<std::uint32_t>(x[n]) != std::bit_cast<std::uint32_t>(y[n]) ? 1 : 0;
  }
  EXPECT_EQ(differing, 0U);
}

// The farthest that a voxel's centre moved [m].
double moved_m(const Volume& a, const Volume& b) {
  double most = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p_L = Vec3i(corner & 1, corner >> 1 & 1, corner >> 2).cwiseProduct(a.size()).cast<double>();
    most = std::max(most, (a.lattice().toWorld(p_L) - b.lattice().toWorld(p_L)).norm());
  }
  return most;
}

// Doubles: direction, spacing and origin are each rounded some ten times on their way out and back (products, a norm, a
// quotient, decimal digits, making the axes orthonormal), each by 2^-53 of a number below `reach`.
// 32-bit floats: the origin is off by 2^-25 of itself an axis; steps, by 2^-25 of themselves in each of three
// components, for each axis' way across the volume, and as much again by the quaternion's three rounded components,
// whose errors turn the axes by up to 2 * sqrt(3) * 2^-25. All against `reach`: below 16 * 2^-25.
double bound_m(const Volume& volume, bool floats) {
  const Vec3 across = volume.size().cast<double>().cwiseProduct(volume.lattice().spacing_m);
  const double reach = volume.lattice().origin_W.norm() + across.sum();
  return reach * (floats ? 16 * std::ldexp(1.0, -25) : 64 * std::ldexp(1.0, -53));
}

struct Case {
  const char* file;
  bool floats;
};
class VolumeFile : public ::testing::TestWithParam<Case> {};

TEST_P(VolumeFile, GivesBackEveryDensityAndPlace) {
  const TempFolder folder;
  for (const bool left_handed : {false, true}) {
    for (const Vec3i& size : {Vec3i(19, 17, 11), Vec3i(2, 3, 5), Vec3i(16, 8, 24)}) {
      const Volume volume = awkward(size, crooked(left_handed));
      save(volume, folder.file(GetParam().file));
      const Volume back = loadVolume(folder.file(GetParam().file));
      expectSameValues(volume, back);
      EXPECT_LE(moved_m(volume, back), bound_m(volume, GetParam().floats)) << left_handed;
      EXPECT_EQ(back.lattice().R_WL.determinant() < 0, left_handed);
      EXPECT_EQ(back.minimum(), volume.minimum());
      EXPECT_EQ(back.maximum(), volume.maximum());
      EXPECT_EQ(back.facts().remark, "");  // a NIfTI file's two forms agree
    }
  }
}

// Integers stay integers where all of them fit; -0, fractions and larger numbers make floats.
TEST_P(VolumeFile, IntegersStayWhatTheyWere) {
  const TempFolder folder;
  const std::string path = folder.file(GetParam().file);
  const Volume whole = awkward({9, 10, 11}, crooked(true), "int16");
  save(whole, path);
  expectSameValues(whole, loadVolume(path));
  const bool is_vdb = std::string(GetParam().file).ends_with(".vdb");
  EXPECT_EQ(loadVolume(path).facts().value_type, is_vdb ? "float" : "int16");
  for (const float odd : {-0.0F, 0.5F, 32768.0F}) {
    Volume changed = awkward({9, 10, 11}, crooked(true), "uint8");
    std::vector<float> brick(kBrickVoxels, odd);
    brick[3] = 7;
    changed.setBrick({0, 0, 0}, brick.data());
    save(changed, path);
    const Volume back = loadVolume(path);
    expectSameValues(changed, back);
    EXPECT_EQ(back.facts().value_type, is_vdb ? "float" : "float32") << odd;
  }
}

// OpenVDB gives every file a new identity, 36 letters behind magic number, versions and a flag of 21 bytes in all; our
// checksum, the last 16 bytes, covers it.
TEST_P(VolumeFile, WritesTheSameBytesEveryTime) {
  constexpr std::size_t kVdbHead = 21 + 36, kChecksum = 16;
  const bool is_vdb = std::string(GetParam().file).ends_with(".vdb");
  const TempFolder folder;
  const Volume volume = awkward({9, 10, 11}, crooked(false));
  const auto bytes = [&] {
    save(volume, folder.file(GetParam().file));
    const std::string all = readFile(folder.file(GetParam().file));
    return is_vdb ? all.substr(kVdbHead, all.size() - kVdbHead - kChecksum) : all;
  };
  const std::string first = bytes();
  EXPECT_GT(first.size(), 1000U);
  EXPECT_EQ(first, bytes());
}

// A sink that throws, as a full disk does, ends the writing with what it threw.
TEST_P(VolumeFile, WhatTheSinkThrowsComesThrough) {
  const Volume volume = awkward({40, 40, 40}, crooked(false));
  std::size_t taken = 0;
  const auto full = [&](std::string_view bytes) {
    taken += bytes.size();
    if (taken > 2000) throw Error(Error::Code::kIo, "x", "the disk is full", "make room");
  };
  try {
    writeVolume(volume, GetParam().file, {}, full);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::Code::kIo);
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, VolumeFile,
                         ::testing::Values(Case{"a.nrrd", false}, Case{"a.NII", true}, Case{"a.nii.gz", true},
                                           Case{"a.mha", false}, Case{"a.vdb", false}),
                         [](const auto& test) {
                           std::string name = test.param.file + 2;
                           std::replace(name.begin(), name.end(), '.', '_');
                           return name;
                         });

// From -32768 to 32767, whole, and of integers only.
TEST(TypeToWrite, IsAnIntegersWhereAllOfThemFit) {
  const auto typeOf = [](float low, float high, const char* type, float among = 0) {
    std::vector<float> values(std::size_t{2} * 512, low);
    std::fill(values.begin() + 512, values.end(), high);
    values[600] = among;
    VolumeFacts facts;
    facts.value_type = type;
    return typeToWrite(Volume::fromDense({8, 8, 16}, Lattice{}, values, facts));
  };
  EXPECT_EQ(typeOf(-32768, 32767, "int16"), ValueType::kInt16);
  EXPECT_EQ(typeOf(0, 255, "uint8"), ValueType::kInt16);
  EXPECT_EQ(typeOf(-32769, 32767, "int32"), ValueType::kFloat32);
  EXPECT_EQ(typeOf(-32768, 32768, "uint16"), ValueType::kFloat32);
  EXPECT_EQ(typeOf(0, 255, "float32"), ValueType::kFloat32);
  EXPECT_EQ(typeOf(0, 255, "int16", 0.5F), ValueType::kFloat32);
  EXPECT_EQ(typeOf(0, 255, "int16", -0.0F), ValueType::kFloat32);
}

TEST(CheckNotInput, RefusesTheInputAndAFileOfItsFolder) {
  const TempFolder folder;
  std::filesystem::create_directory(folder.file("scans"));
  writeFile(folder.file("a.nrrd"), "x");
  writeFile(folder.file("b.nrrd"), "x");
  writeFile(folder.file("scans/s.dcm"), "x");
  const auto refuses = [](const std::string& in, const std::string& out, const std::string& reason) {
    expectRefusal([&] { checkNotInput(in, out); }, out, reason + "; write to another name");
  };
  refuses(folder.file("a.nrrd"), folder.file("a.nrrd"), "it is the input");
  refuses(folder.file("a.nrrd") + "?nan=0", folder.file("scans/../a.nrrd"), "it is the input");
  refuses(folder.file("scans"), folder.file("scans/s.dcm"), "it is a file of the input's folder");
  EXPECT_NO_THROW(checkNotInput(folder.file("a.nrrd"), folder.file("b.nrrd")));
  EXPECT_NO_THROW(checkNotInput(folder.file("a.nrrd"), folder.file("new.nrrd")));
  EXPECT_NO_THROW(checkNotInput(folder.file("scans"), folder.file("a.nrrd")));
  EXPECT_NO_THROW(checkNotInput("phantom:knot", folder.file("a.nrrd")));
}

TEST(VolumeFileVdb, CanBeInMetres) {
  const TempFolder folder;
  const Volume volume = awkward({9, 10, 11}, crooked(true));
  save(volume, folder.file("m.vdb"), LengthUnit::kMetre);
  const Volume back = loadVolume(folder.file("m.vdb"));
  expectSameValues(volume, back);
  EXPECT_LE(moved_m(volume, back), bound_m(volume, false));
}

// OpenVDB refuses voxels of less than some 14 um where its unit is the metre.
TEST(VolumeFileVdb, RefusesVoxelsTooSmallForMetres) {
  Lattice lattice;
  lattice.spacing_m = Vec3::Constant(5e-6);
  const TempFolder folder;
  const Volume volume = awkward({9, 10, 11}, lattice);
  try {
    save(volume, folder.file("m.vdb"), LengthUnit::kMetre);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("--unit mm"));
  }
  save(volume, folder.file("mm.vdb"));
  EXPECT_LE(moved_m(volume, loadVolume(folder.file("mm.vdb"))), bound_m(volume, false));
}

// A ball as minus its distance, cut off at three voxels, as a narrow band is.
Volume levelSet() {
  Lattice lattice = crooked(false);
  lattice.spacing_m = Vec3::Constant(0.5e-3);
  const Vec3i size(30, 31, 33);
  std::vector<float> values;
  for (int k = 0; k < size.z(); ++k) {
    for (int j = 0; j < size.y(); ++j) {
      for (int i = 0; i < size.x(); ++i) {
        const double depth_m = 0.5e-3 * (9.3 - (Vec3(i, j, k) - Vec3(15, 15, 16)).norm());
        values.push_back(static_cast<float>(std::clamp(depth_m, -1.5e-3, 1.5e-3)));
      }
    }
  }
  VolumeFacts facts;
  facts.source = "test";
  facts.is_level_set = true;
  return Volume::fromDense(size, lattice, values, facts);
}

TEST(VolumeFileVdb, ALevelSetStaysOne) {
  const TempFolder folder;
  const Volume volume = levelSet();
  save(volume, folder.file("a.vdb"));
  const Volume back = loadVolume(folder.file("a.vdb"));
  EXPECT_TRUE(back.facts().is_level_set);
  expectSameValues(volume, back);
  EXPECT_LE(moved_m(volume, back), bound_m(volume, false));
}

// In millimetres distances are rounded once more: to 2^-23 of themselves.
TEST(VolumeFileVdb, ALevelSetInMillimetresIsRounded) {
  const TempFolder folder;
  const Volume volume = levelSet();
  save(volume, folder.file("a.vdb"), LengthUnit::kMillimetre);
  const Volume back = loadVolume(folder.file("a.vdb"));
  EXPECT_TRUE(back.facts().is_level_set);
  ASSERT_EQ(back.size(), volume.size());
  const std::vector<float> x = volume.toDense(), y = back.toDense();
  for (std::size_t n = 0; n < x.size(); ++n) ASSERT_NEAR(x[n], y[n], std::abs(x[n]) * std::ldexp(1.0, -23));
}

void expectRefused(const std::string& name, std::optional<LengthUnit> unit, const Volume& volume,
                   const std::string& words) {
  try {
    writeVolume(volume, name, unit, [](std::string_view) { FAIL() << "bytes before the refusal"; });
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::Code::kBadInput);
    EXPECT_THAT(error.what(), HasSubstr(words));
  }
}

TEST(VolumeFileRefusals, NameWhatToDo) {
  const Volume volume = awkward({9, 10, 11}, crooked(false));
  expectRefused("a.tiff", {}, volume, ".nrrd");
  expectRefused("nrrd", {}, volume, ".nrrd");
  expectRefused("a.nii", LengthUnit::kMetre, volume, "leave --unit out");
  VolumeFacts facts;
  facts.source = "long";
  const Volume stick = Volume::fromBricks({32768, 2, 2}, Lattice{}, facts, [](const Vec3i&, float* values) {
    values[0] = 1;
    return true;
  });
  expectRefused("a.nii", {}, stick, "write .nrrd or .vdb");
}

// A domain that ends with its bricks is written without a copy; what was edited is in it.
TEST(VolumeFileVdb, WholeBricksComeBackToo) {
  const TempFolder folder;
  Volume volume = awkward({16, 24, 32}, crooked(true));
  std::vector<float> values(kBrickVoxels, 5.0F);
  values[77] = -7.0F;
  volume.setBrick({1, 2, 3}, values.data());
  volume.setConstantBrick({1, 0, 0}, 3.25F);
  for (const LengthUnit unit : {LengthUnit::kMillimetre, LengthUnit::kMetre}) {
    save(volume, folder.file("a.vdb"), unit);
    const Volume back = loadVolume(folder.file("a.vdb"));
    expectSameValues(volume, back);
    EXPECT_LE(moved_m(volume, back), bound_m(volume, false));
  }
}

TEST(SaveVolume, ReplacesWholeFilesOnly) {
  const TempFolder folder;
  const Volume volume = awkward({9, 10, 11}, crooked(false));
  for (const char* name : {"a.vdb", "a.nrrd", "a.nii", "a.nii.gz", "a.mha"}) {
    const std::string path = folder.file(name);
    std::ofstream(path) << "old";
    const std::uint64_t bytes = saveVolume(volume, path);
    EXPECT_EQ(bytes, std::filesystem::file_size(path));
    expectSameValues(loadVolume(path), volume);
  }
  EXPECT_THROW(saveVolume(volume, folder.file("a.tiff")), Error);
  EXPECT_THROW(saveVolume(volume, folder.file("no/a.vdb")), Error);
}

}  // namespace volume_file_test
}  // namespace palpate
