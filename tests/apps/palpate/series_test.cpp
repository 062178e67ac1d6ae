// SPDX-License-Identifier: Apache-2.0
// A DICOM folder of several series: each verb that loads a volume takes one of them, and none by itself.
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "program_test.hpp"
#include "tests/engine/files/samples.hpp"

namespace palpate {
namespace series_test {

using testing::HasSubstr;

// Each a ball of 5 mm radius in voxels of 1 mm, with 0 at its surface; only their sizes differ.
class Series : public ProgramTest {
 protected:
  struct Ball {
    const char* uid;
    Vec3i size;
    [[nodiscard]] double density(int i, int j, int k) const {
      const Vec3 from_middle = Vec3(i, j, k) - (size.cast<double>() - Vec3::Ones()) / 2;
      return std::round(100 * (5 - from_middle.norm()));
    }
  };
  const Ball first_ = {"1.2.3.4.5", {16, 16, 16}};
  const Ball second_ = {"1.2.3.9", {18, 17, 15}};  // UIDs are in alphabetical order

  Series() {
    std::filesystem::create_directory(file("scan"));
    for (const Ball* ball : {&second_, &first_}) writeSlices(*ball);
  }

  void writeSlices(const Ball& ball) const {
    for (int k = 0; k < ball.size.z(); ++k) {
      DicomFields fields;
      fields.series = ball.uid;
      fields.sop = fmt::format("{}.{}", ball.uid, k + 1);
      fields.position = fmt::format("0\\0\\{}", k);
      fields.pixel_spacing = "1\\1";
      fields.slope = "1";
      fields.intercept = "0";
      fields.columns = ball.size.x();
      fields.rows = ball.size.y();
      for (int j = 0; j < ball.size.y(); ++j) {
        for (int i = 0; i < ball.size.x(); ++i) fields.pixels.push_back(ball.density(i, j, k));
      }
      write(fmt::format("scan/{}-{}.dcm", ball.uid, k), dicomBytes(fields));
    }
  }

  static void expectBall(const Volume& volume, const Ball& ball) {
    ASSERT_EQ(volume.size(), ball.size);
    const std::vector<float> values = volume.toDense();
    std::size_t n = 0;
    for (int k = 0; k < ball.size.z(); ++k) {
      for (int j = 0; j < ball.size.y(); ++j) {
        for (int i = 0; i < ball.size.x(); ++i)
          ASSERT_EQ(values[n++], static_cast<float>(ball.density(i, j, k))) << i << ' ' << j << ' ' << k;
      }
    }
  }
};

TEST_F(Series, NoneIsChosenAndAllAreListed) {
  for (const Words& verb : {Words{"info", "scan"}, Words{"convert", "scan", "o.nrrd"}, quickTouch("scan")}) {
    const Outcome outcome = run(verb);
    expectRefusal(outcome, "scan",
                  "the folder holds 2 series: 1: 1.2.3.4.5 (16 slices), 2: 1.2.3.9 (15 slices); choose one: --series 1",
                  2);
    EXPECT_EQ(outcome.out, "");
  }
  EXPECT_FALSE(exists("o.nrrd"));
  EXPECT_FALSE(exists("out"));
}

TEST_F(Series, InfoPrintsTheOneThatIsChosen) {
  for (const char* second : {"2", "1.2.3.9"}) {
    const Outcome outcome = run({"info", "scan", "--series", second});
    expectSuccess(outcome);
    EXPECT_THAT(outcome.out, HasSubstr("\n  part         series 2 of 2: 1.2.3.9\n"));
    EXPECT_THAT(outcome.out, HasSubstr("\n  size         18 x 17 x 15 voxels\n"));
  }
  EXPECT_THAT(run({"info", "scan", "--series", "1"}).out, HasSubstr("series 1 of 2: 1.2.3.4.5\n"));
}

TEST_F(Series, ConvertWritesTheOneThatIsChosen) {
  for (const char* second : {"2", "1.2.3.9"}) {
    expectSuccess(run({"convert", "scan", "o.nrrd", "--series", second}));
    expectBall(loadVolume(file("o.nrrd").string()), second_);
  }
  expectSuccess(run({"convert", "scan", "o.nrrd", "--series", "1"}));
  expectBall(loadVolume(file("o.nrrd").string()), first_);
}

TEST_F(Series, TouchFeelsTheOneThatIsChosen) {
  for (const char* second : {"2", "1.2.3.9"}) {
    expectSuccess(run(quickTouch("scan", {"--series", second, "--iso", "0"})));
    const auto summary = nlohmann::json::parse(contentsOf(file("out/summary.json")));
    EXPECT_EQ(summary["volume"]["size_voxel"], (nlohmann::json{18, 17, 15}));
    EXPECT_GT(summary["contact"]["ticks"], 0);
  }
}

TEST_F(Series, OneThatIsNotThereIsRefused) {
  for (const char* none : {"0", "3", "1.2.3", "first"}) {
    const Words series = {"--series", none};
    for (const Words& verb : {Words{"info", "scan"}, Words{"convert", "scan", "o.nrrd"}, quickTouch("scan")}) {
      const Outcome outcome = run(verb + series);
      expectRefusal(outcome, "scan", fmt::format("the folder has no series {}; choose one of 1: 1.2.3.4.5", none), 2);
    }
  }
  EXPECT_FALSE(exists("o.nrrd"));
  EXPECT_FALSE(exists("out"));
}

// Slices of the first series, shifted by half a millimetre each: refused, and made upright where the user says so, by a
// flag, by a scene or in the volume's name.
TEST_F(Series, OfATiltedGantryAreResampledOnRequest) {
  std::filesystem::create_directory(file("tilted"));
  for (int k = 0; k < 12; ++k) {
    DicomFields fields;
    fields.sop = fmt::format("1.2.{}", k + 1);
    fields.position = fmt::format("0\\{}\\{}", 0.5 * k, k);
    fields.pixel_spacing = "1\\1";
    fields.rows = fields.columns = 10;
    for (int p = 0; p < 100; ++p) fields.pixels.push_back(p % 10 > 2 && p % 10 < 7 && k > 2 && k < 9 ? 200 : 0);
    write(fmt::format("tilted/{}.dcm", k), dicomBytes(fields));
  }
  expectRefusal(run({"info", "tilted"}), "tilted", "as under a tilted gantry; give --resample", 2);
  // 11 steps of half a pixel make the block 5.5 pixels longer, so 6; atan(0.5) is 26.6 degrees.
  for (const Words& words : {Words{"info", "tilted", "--resample"}, Words{"info", "tilted?resample"}}) {
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.status, 0);
    EXPECT_THAT(outcome.out + outcome.err, HasSubstr("tilted by 26.6 degrees and were resampled upright"));
    EXPECT_THAT(outcome.out, HasSubstr("\n  size         10 x 16 x 12 voxels\n"));
  }
  const Outcome converted = run({"convert", "tilted", "o.nrrd", "--resample", "--nan", "-500"});
  EXPECT_EQ(converted.status, 0);
  EXPECT_THAT(converted.err, HasSubstr("780 of 1920 voxels have no value and are -500 here"));
  EXPECT_EQ(loadVolume(file("o.nrrd").string()).minimum(), -500);
  write("scene.toml", "volume = \"tilted\"\nresample = \"yes\"\nisovalue = 100\n");
  EXPECT_EQ(run({"touch", "scene.toml", "--seconds", "0.1", "--clock", "simulated", "--out", "out"}).status, 0);
  const auto summary = nlohmann::json::parse(contentsOf(file("out/summary.json")));
  EXPECT_EQ(summary["volume"]["size_voxel"], (nlohmann::json{10, 16, 12}));
  expectRefusal(run({"info", "o.nrrd", "--resample"}), "o.nrrd", "NRRD volumes are not resampled", 2);
}

// What has no series is no folder of them; and one choice is enough.
TEST_F(Series, AreOfFoldersAndChosenOnce) {
  expectRefusal(run({"info", "phantom:sphere?size=16", "--series", "1"}), "phantom:sphere", "it has no series", 2);
  expectRefusal(run({"info", "scan#1", "--series", "2"}), "scan#1", "it names a series, and so does --series", 2);
}

}  // namespace series_test
}  // namespace palpate
