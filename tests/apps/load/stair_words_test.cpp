// SPDX-License-Identifier: Apache-2.0
#include "apps/load/stair_words.hpp"

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/files/volume_file.hpp"

namespace palpate {
namespace stair_words_test {

using testing::HasSubstr;
using testing::Not;

// Balls around one middle, each with the label of the smallest that holds the voxel.
Volume balls(const std::vector<double>& radii, float scale = 1) {
  std::vector<float> values;
  for (int k = 0; k < 24; ++k) {
    for (int j = 0; j < 24; ++j) {
      for (int i = 0; i < 24; ++i) {
        float label = 0;
        for (const double radius : radii) label += std::hypot(i - 11.3, j - 12.1, k - 11.8) < radius ? scale : 0;
        values.push_back(label);
      }
    }
  }
  return Volume::fromDense(Vec3i::Constant(24), {}, values, {});
}

std::string said(const Volume& volume, double isovalue, const std::string& chain = "",
                 FilterGiven given = FilterGiven::kAsOption) {
  return stairWords(volume, isovalue, makePlan({.filter = chain}), given);
}

TEST(StairWords, NameValuesAndTheFilterThatHelps) {
  const std::string words = said(balls({8}), 0.5);
  EXPECT_THAT(words, HasSubstr("it holds 2 values (0, 1), so its surface is felt as stairs"));
  EXPECT_THAT(words, HasSubstr(std::string("--filter ") + kStairFilter));
  EXPECT_THAT(words, HasSubstr(fmt::format("--filter {} --gradient-operator {} is", kGentleFilter, kGentleGradient)));
  EXPECT_THAT(words, HasSubstr("docs/masks.md"));
  EXPECT_THAT(words, Not(HasSubstr("label")));
  EXPECT_THAT(words, Not(HasSubstr("\n")));
  EXPECT_THAT(said(balls({8}, 255), 100), HasSubstr("2 values (0, 255)"));
}

// A window of a volume has no filters: it says how a file is made.
TEST(StairWords, NameACommandWhereThereIsNoOption) {
  const std::string words = said(balls({8}), 0.5, "", FilterGiven::kAsFile);
  EXPECT_THAT(words, HasSubstr(std::string("'palpate filter IN -o smooth.vdb --filter ") + kStairFilter + "'"));
}

TEST(StairWords, SayThatLabelsAreNames) {
  const Volume labels = balls({10, 7, 4});
  EXPECT_THAT(said(labels, 0.5), HasSubstr("4 values (0, 1, 2, 3)"));
  EXPECT_THAT(said(labels, 0.5),
              HasSubstr("isovalue 0.5 feels those from 1 to 3 as one object: write the label that you want as a mask"));
  EXPECT_THAT(said(labels, 1.5), HasSubstr("isovalue 1.5 feels those from 2 to 3 as one object"));
  EXPECT_THAT(said(labels, 2), HasSubstr("isovalue 2 feels label 3 alone"));
  std::vector<float> eighths = balls({10}).toDense();
  for (std::size_t n = 0; n < eighths.size(); ++n)
    eighths[n] *= static_cast<float>(1 + (n % 24 < 12 ? 1 : 0) + (n / 24 % 24 < 12 ? 2 : 0) + (n / 576 < 12 ? 4 : 0));
  EXPECT_THAT(said(Volume::fromDense(Vec3i::Constant(24), {}, eighths, {}), 0.5), HasSubstr("9 values (0 to 8)"));
}

// A filter smooths labels, too, and makes other places of their surfaces.
TEST(StairWords, OfLabelsAreSaidOfSmoothedOnesToo) {
  const std::string words = said(balls({10, 7, 4}), 1.5, kStairFilter);
  EXPECT_THAT(words,
              testing::StartsWith("it holds 4 values (0, 1, 2, 3); if these are labels, isovalue 1.5 feels those"));
}

// One look has the words for every isovalue.
TEST(StairWords, OfOneLookAreThoseOfALookAtEachIsovalue) {
  const Volume labels = balls({10, 7, 4}), sphere = loadVolume("phantom:sphere?size=24");
  const Stairs stairs = stairsOf(labels, 0.5);
  for (const double isovalue : {-1.0, 0.0, 0.5, 1.5, 2.0, 2.9, 3.0, 1e9, std::nan("")})
    EXPECT_EQ(stairWords(stairs, isovalue, makePlan({}), FilterGiven::kAsOption), said(labels, isovalue)) << isovalue;
  EXPECT_EQ(stairWords(stairsOf(sphere, 0), 0, makePlan({}), FilterGiven::kAsOption), "");
}

// What is named must be what the program takes, and after it nothing is said.
TEST(StairWords, TheirAdviceIsTakenAndHelps) {
  const Plan filtered = makePlan({.filter = kStairFilter});
  const Plan gentle = makePlan({.filter = kGentleFilter, .gradient_operator = kGentleGradient});
  for (const Vec3& spacing_m : {Vec3(1e-3, 1e-3, 1e-3), Vec3(4e-4, 4e-4, 6e-3)}) {
    EXPECT_TRUE(smoothsStairs(filtered, spacing_m, 1));
    EXPECT_TRUE(smoothsStairs(gentle, spacing_m, 1));
    EXPECT_FALSE(smoothsStairs(makePlan({}), spacing_m, 1));
  }
  EXPECT_EQ(said(balls({8}), 0.5, kStairFilter), "");
  const Plan smooth_normals = makePlan({.gradient_operator = "gaussian:1.5"});
  EXPECT_EQ(stairWords(balls({8}), 0.5, smooth_normals, FilterGiven::kAsOption), "");
}

TEST(StairWords, AreLeftOutWhereTheChainSmooths) {
  const Volume mask = balls({8});
  for (const char* chain : {"gaussian:1", "median:1 gaussian:1", "gaussian:0.8 gaussian:0.8", "diffuse:10:kappa=10",
                            "bilateral:1.5:range=2", "gaussian:1.5 distance:4"})
    EXPECT_EQ(said(mask, 0.5, chain), "") << chain;
  // Ranks are values that were there before, and a distance is that from the same stairs.
  for (const char* chain :
       {"gaussian:0.5", "median:2", "open:1 close:1", "bilateral:1.5:range=0.3", "distance:4", "median:1 distance:4"})
    EXPECT_NE(said(mask, 0.5, chain), "") << chain;
  EXPECT_NE(stairWords(mask, 0.5, makePlan({.distance = true}), FilterGiven::kAsOption), "");
}

// A length is fewer voxels across slices than within them.
TEST(StairWords, LengthsAreJudgedAlongEachAxis) {
  const Vec3 slices_m(1e-3, 1e-3, 3e-3);
  EXPECT_FALSE(smoothsStairs(makePlan({.filter = "gaussian:1.5mm"}), slices_m, 1));
  EXPECT_TRUE(smoothsStairs(makePlan({.filter = "gaussian:3mm"}), slices_m, 1));
  EXPECT_TRUE(smoothsStairs(makePlan({.filter = "gaussian:1.5mm"}), Vec3::Constant(1e-3), 1));
}

TEST(StairWords, NothingIsSaidOfOtherVolumes) {
  for (const char* name : {"phantom:sphere?size=24", "phantom:head?size=48", "phantom:knot?size=32&noise=0.05"}) {
    const Volume volume = loadVolume(name);
    EXPECT_EQ(said(volume, *volume.facts().declared_isovalue), "") << name;
  }
}

}  // namespace stair_words_test
}  // namespace palpate
