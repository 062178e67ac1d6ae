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

// What has no series is no folder of them; and one choice is enough.
TEST_F(Series, AreOfFoldersAndChosenOnce) {
  expectRefusal(run({"info", "phantom:sphere?size=16", "--series", "1"}), "phantom:sphere", "it has no series", 2);
  expectRefusal(run({"info", "scan#1", "--series", "2"}), "scan#1", "it names a series, and so does --series", 2);
}

}  // namespace series_test
}  // namespace palpate
