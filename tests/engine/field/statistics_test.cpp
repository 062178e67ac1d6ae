// SPDX-License-Identifier: Apache-2.0
#include "engine/field/statistics.hpp"

#include <limits>
#include <numeric>

#include <fmt/format.h>

#include "engine/files/volume_file.hpp"
#include "tests/engine/files/files.hpp"

namespace palpate {
namespace statistics_test {

Volume volumeOf(const std::vector<float>& values, const Vec3i& size) {
  VolumeFacts facts;
  facts.source = "test";
  return Volume::fromDense(size, plainLattice(), values, facts);
}

// 10 x 10 x 20 voxels: the lower half holds `low`, the upper `high`.
Volume halves(float low, float high) {
  std::vector<float> values(2000, low);
  std::fill(values.begin() + 1000, values.end(), high);
  return volumeOf(values, {10, 10, 20});
}

TEST(Statistics, CountsEveryVoxelOnceInConstantAndCutBricks) {
  const VolumeStatistics statistics = statisticsOf(halves(0, 100), 10);
  EXPECT_EQ(statistics.minimum, 0);
  EXPECT_EQ(statistics.maximum, 100);
  EXPECT_EQ(statistics.mean, 50);
  EXPECT_EQ(statistics.histogram.bin_width, 10);
  EXPECT_EQ(statistics.histogram.counts.size(), 10U);
  EXPECT_EQ(statistics.histogram.counts.front(), 1000U);
  EXPECT_EQ(statistics.histogram.counts.back(), 1000U);
}

TEST(Statistics, PutsValuesIntoTheirBins) {
  std::vector<float> values(1000);
  std::iota(values.begin(), values.end(), 0.0F);
  const VolumeStatistics statistics =
      statisticsOf(volumeOf(values, {10, 10, 10}), 9);  // width 111: 0..110, 111..221, ...
  EXPECT_THAT(statistics.histogram.counts, testing::ElementsAre(111, 111, 111, 111, 111, 111, 111, 111, 112));
  EXPECT_EQ(statistics.mean, 499.5);
}

// A mask's surface is half-way between its two values, whatever they are; labels part half-way between two of them.
TEST(Statistics, OtsuLiesInTheMiddleOfAGap) {
  const auto thresholds = [](const std::vector<float>& values) {
    std::vector<double> all;
    for (const IsovalueSuggestion& one :
         statisticsOf(Volume::fromDense({static_cast<int>(values.size()), 1, 1}, {}, values, {})).suggestions)
      all.push_back(one.isovalue);
    return all;
  };
  const auto bins = [](double span) { return span / 256; };  // the highest value lies in the last bin, not behind it
  EXPECT_NEAR(thresholds({0, 0, 0, 0, 0, 1, 1}).at(0), 0.5, bins(1));
  EXPECT_NEAR(thresholds({0, 255, 255, 0, 0, 0}).at(0), 127.5, bins(255));
  EXPECT_NEAR(thresholds({-3, -3, -3, 7}).at(0), 2, bins(10));
  const std::vector<double> three = thresholds({0, 0, 0, 100, 100, 100, 300, 300, 300});
  ASSERT_EQ(three.size(), 3U);
  EXPECT_NEAR(three[0], 200, bins(300));
  EXPECT_NEAR(three[1], 50, bins(300));
  EXPECT_NEAR(three[2], 200, bins(300));
}

// Three equal peaks: any cut between two of them is Otsu's; two classes part one peak from the other two.
TEST(Statistics, OtsuPartsPeaks) {
  std::vector<float> values;
  for (const float peak : {10.0F, 100.0F, 240.0F}) {
    for (int n = 0; n < 720; ++n) values.push_back(peak + static_cast<float>(n % 5));
  }
  const VolumeStatistics statistics = statisticsOf(volumeOf(values, {12, 12, 15}));
  ASSERT_EQ(statistics.suggestions.size(), 3U);
  EXPECT_GT(statistics.suggestions[0].isovalue, 104);
  EXPECT_LE(statistics.suggestions[0].isovalue, 240);
  EXPECT_GT(statistics.suggestions[1].isovalue, 14);
  EXPECT_LE(statistics.suggestions[1].isovalue, 100);
  EXPECT_GT(statistics.suggestions[2].isovalue, 104);
  EXPECT_LE(statistics.suggestions[2].isovalue, 240);
}

TEST(Statistics, SuggestsIsovaluesThatPartTheVolume) {
  for (const Volume& volume : {halves(0, 1), halves(-1e30F, 1e30F), halves(1, std::nextafter(1.0F, 2.0F)),
                               halves(0, std::numeric_limits<float>::denorm_min()), halves(-1000, 2000)}) {
    const VolumeStatistics statistics = statisticsOf(volume);
    ASSERT_FALSE(statistics.suggestions.empty());
    for (const IsovalueSuggestion& one : statistics.suggestions) {
      EXPECT_NO_THROW(checkIsovalue(volume, one.isovalue)) << one.isovalue;
      EXPECT_FALSE(one.reason.empty());
    }
    EXPECT_EQ(defaultIsovalue(volume), statistics.suggestions[0].isovalue);
  }
}

TEST(DefaultIsovalue, KnowsHounsfieldUnitsPhantomsAndLevelSets) {
  EXPECT_EQ(defaultIsovalue(halves(-1000, 2000)), 226);
  EXPECT_EQ(defaultIsovalue(loadVolume("phantom:head")), 300);
  EXPECT_EQ(defaultIsovalue(loadVolume("phantom:lung")), -400);
  EXPECT_EQ(defaultIsovalue(loadVolume("phantom:sphere?noise=0.2")), 0);
  VolumeFacts facts;
  facts.is_level_set = true;
  EXPECT_EQ(defaultIsovalue(Volume::fromDense({2, 2, 2}, plainLattice(), {-1, -1, -1, -1, 2, 2, 2, 2}, facts)), 0);
}

// What a file keeps comes before all that could be guessed, and the guesses stay.
TEST(DefaultIsovalue, IsTheOneThatTheFileKeeps) {
  Volume volume = halves(-1000, 2000);
  volume.keepIsovalue(-123.25);
  EXPECT_EQ(defaultIsovalue(volume), -123.25);
  EXPECT_EQ(statisticsOf(volume).suggestions.at(1).isovalue, 226);
  Volume phantom = loadVolume("phantom:sphere?size=16");
  phantom.keepIsovalue(10);
  EXPECT_EQ(defaultIsovalue(phantom), 10);
}

// Damaged, or the object that it was the surface of is gone: no other one in its place unasked. What the user says
// goes.
TEST(DefaultIsovalue, RefusesAKeptOneThatPartsNothing) {
  for (const double kept : {-1000.5, 2000.0, std::nan(""), std::numeric_limits<double>::infinity(), -1e300}) {
    Volume volume = halves(-1000, 2000);
    volume.keepIsovalue(kept);
    expectRefusal([&] { static_cast<void>(defaultIsovalue(volume)); }, "test",
                  fmt::format("the isovalue {:g} that it keeps is {} its values, -1000 to 2000{}; try 226", kept,
                              kept == 2000 ? "the highest of" : "outside",
                              kept == 2000 ? ", and object is only what is denser" : ""));
    EXPECT_EQ(statisticsOf(volume).suggestions.at(0).isovalue, 226);
    EXPECT_NO_THROW(checkIsovalue(volume, 0));
  }
}

TEST(CheckIsovalue, RefusesValuesOutsideWithTheRangeAndSuggestions) {
  const Volume volume = halves(-1000, 2000);
  for (const double isovalue : {-1000.5, 1e9, std::nan("")}) {
    expectRefusal([&] { checkIsovalue(volume, isovalue); }, "test",
                  "is outside its values, -1000 to 2000; try 226 (bone");
  }
  expectRefusal(
      [&] { checkIsovalue(volume, 2000); }, "test",
      "isovalue 2000 is the highest of its values, -1000 to 2000, and object is only what is denser; try 226");
  EXPECT_NO_THROW(checkIsovalue(volume, -1000));
  EXPECT_NO_THROW(checkIsovalue(volume, 1999.9));
}

TEST(CheckIsovalue, RefusesConstantVolumes) {
  const Volume volume = halves(40, 40);
  expectRefusal([&] { static_cast<void>(defaultIsovalue(volume)); }, "test",
                "every voxel is 40; there is no isosurface");
  expectRefusal([&] { checkIsovalue(volume, 40); }, "test", "every voxel is 40");
  EXPECT_TRUE(statisticsOf(volume).suggestions.empty());
}

// A value farther below all others than these lie apart is most likely no data; a mask of two values has none.
TEST(Statistics, PointsOutWhatIsMostLikelyNoData) {
  std::vector<float> values(1000, -32768);
  for (std::size_t i = 250; i < values.size(); ++i) values[i] = static_cast<float>(i % 1000) - 1000;
  EXPECT_EQ(statisticsOf(volumeOf(values, {10, 10, 10})).fill_share, 0.25);
  values[0] = -20000;  // halfway: no gap that wide any more
  EXPECT_EQ(statisticsOf(volumeOf(values, {10, 10, 10})).fill_share, 0);
  EXPECT_EQ(statisticsOf(halves(0, 1)).fill_share, 0);
}

// Of the densities themselves, not of a histogram's bins, which one that lies far away makes as wide as it likes.
TEST(Statistics, MeanAboveIsThatOfTheDensities) {
  std::vector<float> values = {-3e38F, 0, 10, 20, 30, 90, 0, 0};
  EXPECT_DOUBLE_EQ(meanAbove(volumeOf(values, {2, 2, 2}), 10), (20.0 + 30 + 90) / 3);
  EXPECT_DOUBLE_EQ(meanAbove(volumeOf(values, {2, 2, 2}), 90), 90);
}

TEST(Statistics, RefusesAbsurdBinCounts) {
  const Volume volume = halves(0, 1);
  for (const int bins : {0, -1, 2000000}) {
    expectRefusal([&] { static_cast<void>(statisticsOf(volume, bins)); }, "histogram", "bins");
  }
}

}  // namespace statistics_test
}  // namespace palpate
