// SPDX-License-Identifier: Apache-2.0
// Slices of a tilted gantry, resampled onto upright axes.
#include "engine/files/dicom_upright.hpp"

#include <cmath>
#include <functional>

#include <fmt/format.h>

#include "engine/files/volume_name.hpp"
#include "tests/engine/files/dicom_writer.hpp"

namespace palpate {
namespace dicom_upright_test {

constexpr int kColumns = 7;
constexpr int kRows = 6;
constexpr double kPixelX_mm = 0.5, kPixelY_mm = 0.75, kGap_mm = 2;

// Slices 2 mm apart. Slice k is shifted by k times `step_mm`; its values are those of `field` at its pixels [mm, LPS].
class Tilted : public testing::Test {
 protected:
  using Field = std::function<double(double x, double y, double z)>;

  void write(const std::vector<std::array<double, 2>>& shifts_mm, const Field& field,
             const std::function<void(WrittenItem&)>& change = {}) const {
    for (std::size_t k = 0; k < shifts_mm.size(); ++k) {
      const auto [x0, y0] = shifts_mm[k];
      WrittenImage image;
      image.rows = kRows;
      image.columns = kColumns;
      for (int j = 0; j < kRows; ++j) {
        for (int i = 0; i < kColumns; ++i)
          image.words.push_back(
              std::llround(field(x0 + i * kPixelX_mm, y0 + j * kPixelY_mm, kGap_mm * static_cast<double>(k))));
      }
      WrittenItem set = imageSet(image);
      placeAt(set, fmt::format("{}\\{}\\{}", x0, y0, kGap_mm * static_cast<double>(k)));
      if (change) change(set);
      writeFile(folder_.file(fmt::format("s{}.dcm", k)), DicomWriter(kLittleEndianDicom).file(set));
    }
  }
  static std::vector<std::array<double, 2>> steps(int slices, double x_mm, double y_mm) {
    std::vector<std::array<double, 2>> shifts;
    for (int k = 0; k < slices; ++k) shifts.push_back({k * x_mm, k * y_mm});
    return shifts;
  }
  [[nodiscard]] std::string upright(const std::string& more = "") const { return folder_.path() + "?resample" + more; }

  TempFolder folder_;
};

// Bilinear interpolation reproduces a linear field. Its values at pixels are whole numbers below 2^10 times 400, which
// floats hold exactly; the sum of four products in double is off by 4 x 2^-53 of them, so what is left is the one
// rounding to float, 2^-24 of the value, and the place of a voxel that the lattice gives in metres: 2^-50 of it at
// most. Along the slices' order the field is anything: heights are kept.
TEST_F(Tilted, AFieldThatIsLinearInEachSliceIsReproduced) {
  // Shifts of 0.3 mm are 0.6 pixels; values at pixels are multiples of 400 x 0.1 x 0.5 = 20 and so whole.
  const auto field = [](double x, double y, double z) { return 400 * x - 240 * y + 50 * z * z - 700; };
  for (const auto& [x_mm, y_mm] : {std::pair{0.3, 0.0}, {0.0, 0.5}, {-0.7, 0.25}, {0.05, -1.5}, {0.5, 0.75}}) {
    SCOPED_TRACE(fmt::format("{} {}", x_mm, y_mm));
    write(steps(5, x_mm, y_mm), field);
    const Volume volume = loadVolume(upright("&nan=-9999"));
    const auto covers = [](int pixels, double step, double pixel) {
      return pixels + static_cast<int>(std::ceil(4 * std::abs(step) / pixel - 1e-9));
    };
    EXPECT_EQ(volume.size(), Vec3i(covers(kColumns, x_mm, kPixelX_mm), covers(kRows, y_mm, kPixelY_mm), 5));
    int inside = 0;
    for (int k = 0; k < 5; ++k) {
      for (int j = 0; j < volume.size().y(); ++j) {
        for (int i = 0; i < volume.size().x(); ++i) {
          const Vec3 p_mm = volume.lattice().toWorld(Vec3(i, j, k)) * 1e3;
          const double x = p_mm.x() - k * x_mm, y = p_mm.y() - k * y_mm;
          const bool within =
              x > -1e-9 && x < (kColumns - 1) * kPixelX_mm + 1e-9 && y > -1e-9 && y < (kRows - 1) * kPixelY_mm + 1e-9;
          inside += within ? 1 : 0;
          const double want = within ? field(p_mm.x(), p_mm.y(), p_mm.z()) : -9999;
          EXPECT_NEAR(volume.value({i, j, k}), want, std::ldexp(std::abs(want) + 1000, -24))
              << i << " " << j << " " << k;
        }
      }
    }
    EXPECT_GE(inside, 5 * (kColumns - 1) * (kRows - 1));  // of whole pixels, as many as a slice has cells
  }
}

// Slices of any directions, each one step from the one before.
struct Gantry {
  Vec3 columns, rows;  // directions in which columns and rows are counted
  Vec3 first_mm, step_mm;
  [[nodiscard]] Vec3 normal() const { return columns.cross(rows); }
  [[nodiscard]] Vec3 place_mm(int slice) const { return first_mm + slice * step_mm; }
};

std::string numbersText(const Vec3& v) {
  return fmt::format("{:.15g}\\{:.15g}\\{:.15g}", v.x(), v.y(), v.z());
}

// Densities of a field that is linear in the world, in steps of 2^-10. Words are rounded to half a step, 2^-11, and
// bilinear interpolation makes that no more. A float rounds by 2^-24 of the density. Cosines and places are written to
// 15 digits: 1e-12 mm, and a density changes by 50 for each mm.
class AnyGantry : public Tilted {
 protected:
  static constexpr int kSlices = 5;
  static double field(const Vec3& p_mm) { return p_mm.dot(Vec3(40, -24, 15)) + 7; }

  void write(const Gantry& gantry) const {
    for (int k = 0; k < kSlices; ++k) {
      WrittenImage image;
      image.rows = kRows;
      image.columns = kColumns;
      image.bits_allocated = image.bits_stored = 32;
      image.high_bit = 31;
      for (int j = 0; j < kRows; ++j) {
        for (int i = 0; i < kColumns; ++i) {
          const Vec3 p_mm = gantry.place_mm(k) + i * kPixelX_mm * gantry.columns + j * kPixelY_mm * gantry.rows;
          image.words.push_back(std::llround(1024 * field(p_mm)));
        }
      }
      WrittenItem set = imageSet(image);
      set[0x00200032] = textOf("DS", numbersText(gantry.place_mm(k)));
      set[0x00200037] = textOf("DS", numbersText(gantry.columns) + "\\" + numbersText(gantry.rows));
      set[0x00280030] = textOf("DS", fmt::format("{}\\{}", kPixelY_mm, kPixelX_mm));
      set[0x00281052] = textOf("DS", "0");
      set[0x00281053] = textOf("DS", "0.0009765625");
      writeFile(folder_.file(fmt::format("s{}.dcm", k)), DicomWriter(kLittleEndianDicom).file(set));
    }
  }

  void expectField(const Gantry& gantry) const {
    const Volume volume = loadVolume(upright("&nan=-9999"));
    const double gap_mm = gantry.step_mm.dot(gantry.normal());
    ASSERT_EQ(volume.size().z(), kSlices);
    Mat3 axes;
    axes << gantry.columns, gantry.rows, gantry.normal();
    EXPECT_LT((volume.lattice().R_WL - axes).norm(), 1e-9);
    EXPECT_LT((volume.lattice().spacing_m * 1e3 - Vec3(kPixelX_mm, kPixelY_mm, gap_mm)).norm(), 1e-9);
    int inside = 0;
    for (int k = 0; k < kSlices; ++k) {
      for (int j = 0; j < volume.size().y(); ++j) {
        for (int i = 0; i < volume.size().x(); ++i) {
          const Vec3 p_mm = volume.lattice().toWorld(Vec3(i, j, k)) * 1e3;
          const Vec3 from_mm = p_mm - gantry.place_mm(k);
          EXPECT_LT(std::abs(from_mm.dot(gantry.normal())), 1e-9);  // in the slice's plane
          const double u = from_mm.dot(gantry.columns) / kPixelX_mm, v = from_mm.dot(gantry.rows) / kPixelY_mm;
          const bool within = u > -1e-6 && u < kColumns - 1 + 1e-6 && v > -1e-6 && v < kRows - 1 + 1e-6;
          inside += within ? 1 : 0;
          const double want = within ? field(p_mm) : -9999;
          EXPECT_NEAR(volume.value({i, j, k}), want, std::ldexp(1, -11) + std::ldexp(std::abs(want), -24) + 1e-6)
              << i << " " << j << " " << k;
        }
      }
    }
    EXPECT_GE(inside, kSlices * (kColumns - 1) * (kRows - 1));
    EXPECT_LE(inside, kSlices * kColumns * kRows);
  }
};

// The table moves along z and the gantry leans, by what scanners allow: cosines are tilted, and only z changes from
// slice to slice.
TEST_F(AnyGantry, ThatLeansKeepsALinearField) {
  for (const double degrees : {-30.0, -12.5, 20.0, 30.0}) {
    SCOPED_TRACE(degrees);
    const double angle = degrees / 180 * std::acos(-1.0);
    const Gantry gantry = {Vec3::UnitX(), Vec3(0, std::cos(angle), -std::sin(angle)), Vec3(-125, -90.5, 33),
                           Vec3(0, 0, 2.5)};
    write(gantry);
    expectLoadRefusal(folder_.path(), "are shifted sideways, as under a tilted gantry");
    expectField(gantry);
    EXPECT_THAT(loadVolume(upright()).facts().remark,
                testing::HasSubstr(fmt::format("tilted by {:.3g} degrees", std::abs(degrees))));
  }
}

TEST_F(AnyGantry, OfAnObliqueDirectionKeepsALinearField) {
  Vec3 columns(0.6, 0.64, 0.48), rows(-0.8, 0.48, 0.36);  // unit vectors, at right angles: -0.48 + 0.3072 + 0.1728
  for (const Vec3& aside_mm : {Vec3(0.3, -0.45, 0), Vec3(-0.7, 0.2, 0), Vec3(0.05, 1.1, 0)}) {
    Gantry gantry = {columns, rows, Vec3(12, -7, 80), Vec3::Zero()};
    gantry.step_mm = 2 * gantry.normal() + aside_mm.x() * columns + aside_mm.y() * rows;
    write(gantry);
    expectField(gantry);
  }
}

TEST_F(Tilted, WhatLiesOutsideIsTheLowestDensityAndTold) {
  write(steps(3, 0.0, 0.75), [](double x, double y, double) { return 100 * x + 40 * y + 7; });
  const Volume volume = loadVolume(upright());
  EXPECT_EQ(volume.size(), Vec3i(kColumns, kRows + 2, 3));
  EXPECT_EQ(volume.value({0, 0, 0}), 7);
  EXPECT_TRUE(volume.facts().resampled);
  EXPECT_EQ(volume.facts().replaced, 42U);
  EXPECT_EQ(volume.value({0, 0, 2}), 7);  // outside: the lowest of all, that of the first pixel
  EXPECT_EQ(volume.value({0, 2, 2}), 40 * 1.5F + 7);
  // atan(0.75 / 2) is 20.556 degrees; two rows of seven lie outside each slice.
  EXPECT_EQ(
      volume.facts().remark,
      "its slices are tilted by 20.6 degrees and were resampled upright; 42 of 168 voxels have no value and are 7 "
      "here, the lowest density (--nan gives another)");
}

// To be outside is catching: a voxel between a pixel that is padding and one that is not has no value.
TEST_F(Tilted, PaddingIsNotMixedIn) {
  const auto field = [](double x, double, double) { return x == 2 ? -5 : 100; };  // the fifth column of slice 0
  write(steps(2, 0.1, 0.0), field, [](WrittenItem& set) { set[0x00280120] = numbersOf("SS", {-5}); });
  const Volume volume = loadVolume(upright("&nan=-9"));
  EXPECT_EQ(volume.size(), Vec3i(8, kRows, 2));
  for (int i = 0; i < 7; ++i) EXPECT_EQ(volume.value({i, 0, 0}), i == 4 ? -9 : 100) << i;
  EXPECT_EQ(volume.value({7, 0, 0}), -9);  // beyond the slice
  EXPECT_EQ(volume.value({0, 0, 1}), -9);  // before the shifted one
  EXPECT_EQ(volume.value({7, 0, 1}), -9);
  EXPECT_EQ(volume.value({4, 0, 1}), 100);
}

// Padding that keeps its density, as the background of a mask does, is a density as any other: half-way between 0 and 1
// it is a half, and outside it is the lowest.
TEST_F(Tilted, PaddingThatStaysIsMixedIn) {
  const auto field = [](double x, double, double) { return x >= 1 && x < 2 ? 1 : 0; };
  const std::vector<std::array<double, 2>> half_a_pixel = steps(2, 0.25, 0.0);
  write(half_a_pixel, field, [](WrittenItem& set) { set[0x00280120] = numbersOf("SS", {0}); });
  const Volume volume = loadVolume(upright());
  // Pixels of slice 0 lie at 0, 0.5, ... 3 mm, those of slice 1 at 0.25, 0.75, ... 3.25, of which 1.25 and 1.75 are 1.
  // So the last column of six voxels lies outside both, and the first one outside slice 1.
  EXPECT_EQ(volume.size(), Vec3i(8, kRows, 2));
  for (const auto& [k, row] : {std::pair(0, std::array{0.0F, 0.0F, 1.0F, 1.0F, 0.0F, 0.0F, 0.0F, 0.0F}),
                               {1, {0.0F, 0.0F, 0.5F, 1.0F, 0.5F, 0.0F, 0.0F, 0.0F}}}) {
    for (int i = 0; i < 8; ++i) EXPECT_EQ(volume.value({i, 2, k}), row[static_cast<std::size_t>(i)]) << i << " " << k;
  }
  EXPECT_EQ(volume.facts().remark,
            "60 of 84 pixels are padding in the files and keep their densities (--nan gives another); its slices are "
            "tilted by 7.13 degrees and were resampled upright; 18 of 96 voxels have no value and are 0 here, the "
            "lowest density (--nan gives another)");
}

// One pixel in the middle is none of a cell.
TEST_F(Tilted, IsRefusedWhereAllVoxelsLieBesidePadding) {
  write(
      steps(2, 0.25, 0.0), [](double x, double y, double z) { return z > 0 && x > 1 && x < 1.5 && y == 1.5 ? 3 : -5; },
      [](WrittenItem& set) { set[0x00280120] = numbersOf("SS", {-5}); });
  expectRefusal([&] { static_cast<void>(loadVolume(upright("&nan=-9"))); }, folder_.path(),
                "no voxel of the upright volume lies between pixels that are not padding");
}

TEST_F(Tilted, UprightSlicesStayAsTheyAre) {
  write(steps(3, 0, 0), [](double x, double y, double z) { return 100 * x + 40 * y + 9 * z; });
  EXPECT_EQ(loadVolume(upright()).toDense(), loadVolume(folder_.path()).toDense());
  EXPECT_FALSE(loadVolume(upright()).facts().resampled);
  EXPECT_EQ(loadVolume(upright()).facts().remark, loadVolume(folder_.path()).facts().remark);
}

TEST_F(Tilted, IsRefusedWithoutResampleAndWhereStepsDiffer) {
  const auto field = [](double x, double, double) { return x; };
  write(steps(3, 0.3, 0), field);
  expectLoadRefusal(folder_.path(),
                    "slices s0.dcm and s1.dcm are shifted sideways, as under a tilted gantry; give "
                    "--resample, or resample the series upright");
  write({{0, 0}, {0.3, 0}, {0.7, 0}, {1.0, 0}}, field);
  expectRefusal([&] { static_cast<void>(loadVolume(upright())); }, folder_.path(),
                "are shifted sideways by another step than the others");
}

// Each step is a twenty-fifth of a pixel, which is let pass; after thirteen of them the shift is half a pixel.
TEST_F(Tilted, StepsThatAreTooSmallToSeeAddUp) {
  const auto field = [](double x, double, double) { return x; };
  write(steps(13, 0.02, 0), field);
  EXPECT_EQ(loadVolume(folder_.path()).size(), Vec3i(kColumns, kRows, 13));
  write(steps(14, 0.02, 0), field);
  expectLoadRefusal(folder_.path(), "slices s12.dcm and s13.dcm are shifted sideways");
  EXPECT_EQ(loadVolume(upright()).size(), Vec3i(kColumns + 1, kRows, 14));
}

TEST_F(Tilted, AnUprightBlockThatIsTooLargeIsRefused) {
  write(steps(2, 1e6, 0), [](double, double, double) { return 1; });
  expectRefusal([&] { static_cast<void>(loadVolume(upright())); }, folder_.path(), "it has 2000007 x 6 x 2 voxels");
}

TEST(ResampleName, IsAWordBehindTheName) {
  TempFolder folder;
  const std::string& path = folder.path();
  EXPECT_EQ(withResample(path), path + "?resample");
  EXPECT_EQ(withResample(path + "?resample"), path + "?resample");
  EXPECT_EQ(withResample(path + "#2?nan=3"), path + "#2?nan=3&resample");
  EXPECT_EQ(withNan(path + "?resample", "3"), path + "?resample&nan=3");
  for (const std::string query : {"?nan=3&resample", "?resample&nan=3"}) {
    const VolumeName name = parseVolumeName(path + "#2" + query);
    EXPECT_EQ(name.path, path);
    EXPECT_EQ(name.part, "2");
    EXPECT_EQ(name.instead_of_nan, 3.0F);
    EXPECT_TRUE(name.resample);
    EXPECT_EQ(name.withPart(), path + "#2");
  }
  EXPECT_FALSE(parseVolumeName(path + "?nan=3").resample);
  EXPECT_EQ(parseVolumeName("none?else=3").path, "none?else=3");
  for (const char* odd : {"?resample&else", "?nan=3&", "?resample&resample", "?nan=3&nan=4", "?resample=yes&nan=3x"}) {
    if (std::string(odd).starts_with("?resample=")) {
      EXPECT_EQ(parseVolumeName(path + odd).path, path + odd);  // no word of ours
      continue;
    }
    expectRefusal([&] { static_cast<void>(parseVolumeName(path + odd)); }, path + odd, "nothing that a volume's name");
  }
  expectRefusal([] { static_cast<void>(withResample("phantom:sphere")); }, "phantom:sphere", "no tilted slices");
  writeFile(folder.file("a.nrrd"), nrrdHeader("short", "raw") + "\n" + bytesOf<std::int16_t>(rampValues()));
  expectLoadRefusal(folder.file("a.nrrd") + "?resample", "NRRD volumes are not resampled");
}

}  // namespace dicom_upright_test
}  // namespace palpate
