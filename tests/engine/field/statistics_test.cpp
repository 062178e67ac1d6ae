// SPDX-License-Identifier: Apache-2.0
#include "engine/field/statistics.hpp"

#include <limits>
#include <numeric>
#include <random>

#include <fmt/format.h>

#include "engine/field/otsu.hpp"
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

// What Otsu maximises, by its definition: the variance of the classes' means, weighted by their voxels [bin^2].
double varianceBetween(const Histogram& histogram, const std::vector<std::size_t>& cuts) {
  double all = 0, sum = 0, variance = 0;
  for (std::size_t bin = 0; bin < histogram.counts.size(); ++bin) {
    all += static_cast<double>(histogram.counts[bin]);
    sum += static_cast<double>(histogram.counts[bin] * bin);
  }
  for (std::size_t n = 0; n + 1 < cuts.size(); ++n) {
    double count = 0, of_class = 0;
    for (std::size_t bin = cuts[n]; bin < cuts[n + 1]; ++bin) {
      count += static_cast<double>(histogram.counts[bin]);
      of_class += static_cast<double>(histogram.counts[bin] * bin);
    }
    if (count > 0) variance += count / all * (of_class / count - sum / all) * (of_class / count - sum / all);
  }
  return variance;
}

// Every way to cut small histograms, empty bins in them or none. A cut's threshold is the middle of its gap, so the cut
// at which the gap begins is meant.
TEST(Otsu, IsTheBestOfAllCuts) {
  std::mt19937 random(5);
  constexpr std::size_t kBins = 9;
  for (int trial = 0; trial < 200; ++trial) {
    Histogram histogram{-4, 0.5, std::vector<std::uint64_t>(kBins)};
    for (std::uint64_t& count : histogram.counts) count = random() % 2 == 0 ? 0 : random() % 7;
    for (const std::size_t bin : {std::size_t{0}, std::size_t{4}, kBins - 1}) histogram.counts[bin] += 1;
    const auto threshold = [&](std::size_t cut) {
      std::size_t end = cut;
      while (histogram.counts[end] == 0) ++end;
      return -4 + 0.5 * 0.5 * static_cast<double>(cut + end);
    };
    const auto begins = [&](std::size_t cut) { return histogram.counts[cut - 1] > 0; };
    double most = 0, most_of_two = 0;
    for (std::size_t low = 1; low < kBins; ++low) {
      most = std::max(most, varianceBetween(histogram, {0, low, kBins}));
      for (std::size_t high = low + 1; high < kBins; ++high)
        most_of_two = std::max(most_of_two, varianceBetween(histogram, {0, low, high, kBins}));
    }
    bool is_best = false, are_best = false;
    const double one = otsuThreshold(histogram);
    const std::pair<double, double> two = otsuThresholds(histogram);
    for (std::size_t low = 1; low < kBins; ++low) {
      if (!begins(low)) continue;
      is_best |= one == threshold(low) && varianceBetween(histogram, {0, low, kBins}) > most - 1e-9;
      for (std::size_t high = low + 1; high < kBins; ++high) {
        are_best |= begins(high) && two == std::pair(threshold(low), threshold(high)) &&
                    varianceBetween(histogram, {0, low, high, kBins}) > most_of_two - 1e-9;
      }
    }
    EXPECT_TRUE(is_best) << trial << ": " << one;
    EXPECT_TRUE(are_best) << trial << ": " << two.first << " " << two.second;
  }
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

std::string suggestionsOf(const Volume& volume) {
  std::string text;
  for (const IsovalueSuggestion& one : statisticsOf(volume).suggestions)
    text += fmt::format("{}{:g} {}", text.empty() ? "" : "; ", one.isovalue, one.reason);
  return text;
}

// Two values that fill the first and the last of 256 bins: the gap's middle is 500. Three classes part two values in a
// gap's first two bins: 500 again, and half a bin (of 3000 / 256) higher.
constexpr const char* kOtsuOfHalves =
    "500 Otsu's threshold, two classes; 500 Otsu's lower threshold, three classes; "
    "505.859 Otsu's upper threshold, three classes";

TEST(Statistics, SuggestsInTheOrderOfWhatIsKnown) {
  EXPECT_EQ(suggestionsOf(halves(-1000, 2000)),
            std::string("226 bone in a CT (InVesalius preset); 300 compact bone in a CT; -300 skin in a CT; ") +
                kOtsuOfHalves);
  const auto with = [](const auto& set) {
    VolumeFacts facts;
    facts.source = "test";
    set(facts);
    std::vector<float> values(2000, -1000.0F);
    std::fill(values.begin() + 1000, values.end(), 2000.0F);
    return suggestionsOf(Volume::fromDense({10, 10, 20}, plainLattice(), values, facts));
  };
  EXPECT_EQ(with([](VolumeFacts& facts) { facts.is_level_set = true; }),
            std::string("0 the level set's surface; ") + kOtsuOfHalves);
  EXPECT_EQ(with([](VolumeFacts& facts) { facts.declared_isovalue = 7; }),
            std::string("7 the phantom's exact surface; ") + kOtsuOfHalves);
  EXPECT_THAT(with([](VolumeFacts& facts) { facts.kept_isovalue = 9; }),
              testing::StartsWith("9 kept in the file; 226 bone in a CT"));
  // At the lowest value there is a surface, at the highest there is none.
  EXPECT_THAT(with([](VolumeFacts& facts) { facts.kept_isovalue = -1000; }), testing::StartsWith("-1000 kept"));
  EXPECT_THAT(with([](VolumeFacts& facts) { facts.kept_isovalue = 2000; }), testing::StartsWith("226 bone"));
  EXPECT_THAT(suggestionsOf(halves(-1000, 300)), testing::Not(testing::HasSubstr("compact bone")));
}

// From -10000 or more up to -900 or less, and 300 or more.
TEST(DefaultIsovalue, TakesNoOtherUnitForHounsfields) {
  for (const auto& [low, high] : {std::pair(-900.0F, 300.0F), std::pair(-10000.0F, 300.0F)})
    EXPECT_EQ(defaultIsovalue(halves(low, high)), 226) << low << " " << high;
  for (const auto& [low, high] : {std::pair(-899.0F, 300.0F), std::pair(-10001.0F, 300.0F), std::pair(-900.0F, 299.0F)})
    EXPECT_EQ(defaultIsovalue(halves(low, high)), (low + high) / 2) << low << " " << high;  // Otsu's
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
    expectRefusal(
        [&] { checkIsovalue(volume, isovalue); }, "test",
        fmt::format("isovalue {:g} is outside its values, -1000 to 2000; try "
                    "226 (bone in a CT (InVesalius preset)), 300 (compact bone in a CT), -300 (skin in a CT), "
                    "500 (Otsu's threshold",
                    isovalue));
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
  // Farther below the others than they lie apart, which is 100: 100 is not, 101 is.
  const auto share = [](float lowest) {
    return statisticsOf(volumeOf({lowest, 0, -50, -100, 0, 0, 0, 0}, {2, 2, 2})).fill_share;
  };
  EXPECT_EQ(share(-200), 0);
  EXPECT_EQ(share(-201), 1.0 / 8);
}

// Of the densities themselves, not of a histogram's bins, which one that lies far away makes as wide as it likes.
TEST(Statistics, MeanAboveIsThatOfTheDensities) {
  std::vector<float> values = {-3e38F, 0, 10, 20, 30, 90, 0, 0};
  EXPECT_DOUBLE_EQ(meanAbove(volumeOf(values, {2, 2, 2}), 10), (20.0 + 30 + 90) / 3);
  EXPECT_DOUBLE_EQ(meanAbove(volumeOf(values, {2, 2, 2}), 90), 90);
}

TEST(Statistics, RefusesAbsurdBinCounts) {
  const Volume volume = halves(0, 1);
  for (const int bins : {0, -1, 1000001}) {
    expectRefusal([&] { static_cast<void>(statisticsOf(volume, bins)); }, "histogram",
                  fmt::format("{} bins; ask for 1 to 1000000", bins));
  }
  for (const int bins : {1, 1000000})
    EXPECT_EQ(statisticsOf(volume, bins).histogram.counts.size(), static_cast<std::size_t>(bins));
}

}  // namespace statistics_test
}  // namespace palpate
