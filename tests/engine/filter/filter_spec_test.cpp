// SPDX-License-Identifier: Apache-2.0
#include "engine/filter/filter_spec.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/typo.hpp"

namespace palpate {
namespace filter_spec_test {

using ::testing::HasSubstr;

TEST(FilterSpec, ReadsAChain) {
  const auto chain = filterChain("gaussian:0.8mm  gaussian:1.5:border=mirror:truncate=4");
  ASSERT_EQ(chain.size(), 2U);
  EXPECT_TRUE(chain[0].size.in_metres);
  EXPECT_DOUBLE_EQ(chain[0].size.value, 0.8e-3);
  EXPECT_DOUBLE_EQ(chain[0].size.voxels(0.4e-3), 2);
  EXPECT_EQ(chain[0].border, Border::kNearest);
  EXPECT_FALSE(chain[1].size.in_metres);
  EXPECT_DOUBLE_EQ(chain[1].size.voxels(0.4e-3), 1.5);
  EXPECT_EQ(chain[1].border, Border::kMirror);
  EXPECT_EQ(chain[1].truncate, 4);
}

TEST(FilterSpec, ReadsFiltersThatKeepEdges) {
  const auto chain = filterChain(
      "bilateral:0.8mm:range=50 bilateral:1:range=2:truncate=1.5:border=mirror "
      "diffuse:10:kappa=100:dt=0.02:g=exp diffuse:3:kappa=5 distance:4");
  ASSERT_EQ(chain.size(), 5U);
  EXPECT_EQ(chain[0].kind, FilterKind::kBilateral);
  EXPECT_EQ(chain[0].truncate, 2);
  EXPECT_EQ(chain[0].range, 50);
  EXPECT_EQ(chain[1].truncate, 1.5);
  EXPECT_EQ(chain[1].border, Border::kMirror);
  EXPECT_EQ(chain[2].kind, FilterKind::kDiffuse);
  EXPECT_EQ(chain[2].kappa, 100);
  EXPECT_EQ(chain[2].dt_mm2, 0.02);
  EXPECT_EQ(chain[2].conductance, Conductance::kExp);
  EXPECT_FALSE(chain[3].dt_mm2.has_value());
  EXPECT_EQ(chain[3].conductance, Conductance::kRational);
  EXPECT_EQ(chain[4].kind, FilterKind::kDistance);
  EXPECT_EQ(chain[4].size.value, 4);
}

TEST(FilterSpec, KnowsEveryUnitAndEveryBound) {
  for (const char* text : {"gaussian:0.8mm", "gaussian:800um", "gaussian:0.08cm", "gaussian:0.0008m"}) {
    const Extent size = filterChain(text).at(0).size;
    EXPECT_TRUE(size.in_metres) << text;
    EXPECT_DOUBLE_EQ(size.value, 0.8e-3) << text;
  }
  // The first and the last that may be given; those just beyond are refused below.
  EXPECT_EQ(filterChain("gaussian:1:truncate=1").at(0).truncate, 1);
  EXPECT_EQ(filterChain("bilateral:1:range=1e30:truncate=8").at(0).truncate, 8);
  EXPECT_EQ(filterChain("diffuse:500:kappa=1e-30:g=rational").at(0).size.value, kMostDiffusionSteps);
  EXPECT_EQ(filterChain("distance:1 distance:6").at(1).size.value, kWidestBand);
  EXPECT_EQ(filterChain("median:1:border=nearest").at(0).border, Border::kNearest);
}

TEST(FilterSpec, ADistanceMovesTheIsovalueToZero) {
  EXPECT_TRUE(hasDistance(filterChain("gaussian:1 distance:4 gaussian:1")));
  EXPECT_FALSE(hasDistance(filterChain("gaussian:1 median:1")));
  EXPECT_EQ(isovalueAfter(filterChain("gaussian:1 diffuse:1:kappa=3"), 226), 226);
  EXPECT_EQ(isovalueAfter(filterChain("gaussian:1 distance:4 gaussian:1"), 226), 0);
}

TEST(FilterSpec, ReadsMedianAndMorphology) {
  const auto chain = filterChain("median:1 dilate:2mm erode:1:shape=ball open:1:shape=box close:3:border=mirror");
  ASSERT_EQ(chain.size(), 5U);
  EXPECT_EQ(chain[0].kind, FilterKind::kMedian);
  EXPECT_EQ(chain[1].kind, FilterKind::kDilate);
  EXPECT_EQ(chain[1].shape, WindowShape::kBox);
  EXPECT_DOUBLE_EQ(chain[1].size.value, 2e-3);
  EXPECT_EQ(chain[2].kind, FilterKind::kErode);
  EXPECT_EQ(chain[2].shape, WindowShape::kBall);
  EXPECT_EQ(chain[3].kind, FilterKind::kOpen);
  EXPECT_EQ(chain[3].shape, WindowShape::kBox);
  EXPECT_EQ(chain[4].kind, FilterKind::kClose);
  EXPECT_EQ(chain[4].border, Border::kMirror);
}

struct Refused {
  const char* text;
  const char* says;
};
TEST(FilterSpec, ANameWithATypoIsRecognised) {
  std::vector<std::string> names;
  for (const FilterWords& words : filterTable()) names.emplace_back(words.name);
  forEachTypo(names, [](const std::string& name, const std::string& typed) {
    const std::string message = refusalOf([&] { static_cast<void>(filterChain(typed + ":1")); });
    EXPECT_THAT(suggestedIn(message), HasSubstr(name)) << message;
  });
}

class RefusedFilter : public testing::TestWithParam<Refused> {};

TEST_P(RefusedFilter, SaysWhatIsWrong) {
  try {
    (void)filterChain(GetParam().text);
    FAIL() << GetParam().text;
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr(GetParam().says)) << GetParam().text;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Texts, RefusedFilter,
    testing::Values(
        Refused{"", "names no filter"}, Refused{"blur:1", "there is no filter 'blur'"},
        Refused{"gaussian", "it has no sigma"}, Refused{"gaussian:0", "is 0"}, Refused{"gaussian:-1mm", "is -1"},
        Refused{"gaussian:5e-324mm", "its sigma is 4.94066e-324; give a number above 0"},
        Refused{"gaussian:nan", "is no number"}, Refused{"gaussian:inf", "is no number"},
        Refused{"gaussian:x", "is no number"}, Refused{"gaussian:1in", "there is no unit 'in'"},
        Refused{"gaussian:1:border=wrap", "there is no border 'wrap'"},
        Refused{"gaussian:1:truncate=99", "give 1 to 8"}, Refused{"gaussian:1:mirror", "has no value"},
        Refused{"gaussian:1:depth=2", "it has no 'depth'"}, Refused{"gaussian:1:range=2", "it has no 'range'"},
        Refused{"bilateral:1", "it has no range"}, Refused{"bilateral:1:range=0", "its range is '0'"},
        Refused{"bilateral:1:range=-3", "its range is '-3'"}, Refused{"bilateral:1:range=nan", "is no number"},
        Refused{"bilateral:1:kappa=1", "it has no 'kappa'"}, Refused{"diffuse:5", "it has no kappa"},
        Refused{"diffuse:2.5:kappa=1", "must be a whole number"},
        Refused{"diffuse:501:kappa=1", "must be a whole number"},
        Refused{"diffuse:5mm:kappa=1", "must be a whole number"}, Refused{"diffuse:5:kappa=0", "its kappa is '0'"},
        Refused{"diffuse:5:kappa=1:dt=-1", "its dt is '-1'"},
        Refused{"diffuse:5:kappa=1:g=linear", "there is no conductance 'linear'"},
        Refused{"diffuse:5:kappa=1:border=mirror", "it has no 'border'"},
        Refused{"distance:7", "a whole number from 1 to 6, without a unit"}, Refused{"distance:1.5", "whole number"},
        Refused{"distance:4mm", "whole number"}, Refused{"distance:4:border=mirror", "it has no 'border'"},
        Refused{"median", "it has no radius"}, Refused{"median:0", "is 0"},
        Refused{"median:1:shape=ball", "it has no 'shape'"}, Refused{"median:1:truncate=3", "it has no 'truncate'"},
        Refused{"dilate", "it has no radius"}, Refused{"close:-1", "is -1"},
        Refused{"erode:1:shape=star", "there is no shape 'star'"}, Refused{"open:1:truncate=3", "it has no 'truncate'"},
        Refused{"gaussian:1:truncate=0.9", "its truncate is '0.9'; give 1 to 8"},
        Refused{"gaussian:1:truncate=8.1", "its truncate is '8.1'; give 1 to 8"},
        Refused{"gaussian:1:truncate=2x", "its truncate is '2x'; give 1 to 8"},
        Refused{"bilateral:1:range=1e31", "its range is '1e31'; give 1e-30 to 1e+30"},
        Refused{"median:1:shape=ball",
                "filter median:1:shape=ball: it has no 'shape'; its keys: border=nearest|mirror"},
        Refused{"gaussian:1 um", "a blank before this unit"}, Refused{"gaussian:1 cm", "a blank before this unit"},
        Refused{"gaussian:1 m", "a blank before this unit"}, Refused{"dilate:", "nothing follows its last colon"},
        Refused{"gaussian:1mm,median:1", "it has a comma"}, Refused{"gaussian:1,5", "decimals by a point"},
        Refused{"gaussian:1 mm", "a blank before this unit"}, Refused{"gaussian:1:", "nothing follows its last colon"},
        Refused{"gaussian:1:truncate=2:truncate=4", "'truncate' stands there twice"}));

}  // namespace filter_spec_test
}  // namespace palpate
