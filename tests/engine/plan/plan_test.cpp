// SPDX-License-Identifier: Apache-2.0
#include "engine/plan/plan.hpp"

#include <algorithm>

#include <gmock/gmock.h>

#include "base/error.hpp"

namespace palpate {
namespace plan_test {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<PlanLine> linesNaming(const std::vector<PlanLine>& lines, const std::string& word) {
  std::vector<PlanLine> found;
  std::copy_if(lines.begin(), lines.end(), std::back_inserter(found),
               [&](const PlanLine& line) { return line.what.find(word) != std::string::npos; });
  return found;
}

TEST(Plan, WithEverythingOrdinaryHasEveryPassInOrder) {
  EXPECT_THAT(makePlan({.draws = true}).passes,
              ElementsAre(Pass::kUpload, Pass::kBrickBounds, Pass::kGradient, Pass::kWindow, Pass::kIsosurface));
}

TEST(Plan, WithoutAPictureHasNoRenderer) {
  const Plan plan = makePlan({});
  EXPECT_FALSE(plan.has(Pass::kIsosurface));
  EXPECT_TRUE(plan.has(Pass::kBrickBounds));  // it still chooses the bricks
}

// All bricks have gradients and nothing is drawn: nobody would read the bounds.
TEST(Plan, LeavesOutBoundsThatNobodyReads) {
  EXPECT_TRUE(makePlan({.gradient_all = true, .draws = true}).has(Pass::kBrickBounds));  // the renderer skips by them
  EXPECT_THAT(makePlan({.gradient_all = true}).passes, ElementsAre(Pass::kUpload, Pass::kGradient, Pass::kWindow));
}

// The distance comes after the filters.
TEST(Plan, FiltersMakeTheFieldThatIsFelt) {
  EXPECT_TRUE(makePlan({}).filters.empty());
  EXPECT_EQ(makePlan({.filter = "median:1"}).filter_words, "median:1");
  EXPECT_EQ(makePlan({.distance = true}).filter_words, "distance:4");
  const Plan both = makePlan({.filter = "median:1", .distance = true});
  EXPECT_EQ(both.filter_words, "median:1 distance:4");
  EXPECT_EQ(both.filters.size(), 2U);
  EXPECT_THAT(both.passes,
              ElementsAre(Pass::kUpload, Pass::kFilter, Pass::kBrickBounds, Pass::kGradient, Pass::kWindow));
  EXPECT_THROW((void)makePlan({.filter = "sharpen"}), Error);
}

// 100 bricks: 60 stored leave out 40 x 2 KiB of density, 25 with gradients leave out 75 x 8 KiB of samples.
TEST(PlanLines, SayWhatWasSaved) {
  const auto lines = planLines(makePlan({}), {.bricks = 100, .stored_bricks = 60, .gradient_bricks = 25});
  const auto density = linesNaming(lines, "density");
  ASSERT_EQ(density.size(), 1U);
  EXPECT_THAT(density[0].what, HasSubstr("60 of 100"));
  EXPECT_EQ(density[0].saved_bytes, 40U * 2048U);
  const auto gradient = linesNaming(lines, "gradient");
  ASSERT_EQ(gradient.size(), 1U);
  EXPECT_THAT(gradient[0].what, HasSubstr("25 of 100"));
  EXPECT_EQ(gradient[0].saved_bytes, 75U * 8192U);
}

// Halves: the bricks that are left out would have taken 4 KiB each, and those that are there take that much less.
TEST(PlanLines, SayHowGradientsAreTakenAndStored) {
  const Plan plan = makePlan({.gradient_operator = "sobel", .half_samples = true});
  EXPECT_TRUE(plan.request.half_samples);
  EXPECT_EQ(plan.gradient.words.name, "sobel");
  EXPECT_FALSE(plan.has(Pass::kSmoothing));
  const auto lines = planLines(plan, {.bricks = 100, .stored_bricks = 60, .gradient_bricks = 25});
  ASSERT_EQ(linesNaming(lines, "gradient").size(), 1U);
  EXPECT_THAT(linesNaming(lines, "gradient")[0].what, HasSubstr("sobel"));
  EXPECT_EQ(linesNaming(lines, "gradient")[0].saved_bytes, 75U * 4096U);
  ASSERT_EQ(linesNaming(lines, "halves").size(), 1U);
  EXPECT_EQ(linesNaming(lines, "halves")[0].saved_bytes, 25U * 4096U);
}

// The smoothed field stays where edits will change it.
TEST(Plan, OfASmoothingOperatorSmoothsFirstAndSaysWhetherThatStays) {
  EngineRequest request{.gradient_operator = "gaussian:0.8mm"};
  EXPECT_THAT(makePlan(request).passes,
              ElementsAre(Pass::kUpload, Pass::kBrickBounds, Pass::kSmoothing, Pass::kGradient, Pass::kWindow));
  const auto once = linesNaming(planLines(makePlan(request), {}), "smoothing");
  ASSERT_EQ(once.size(), 1U);
  EXPECT_THAT(once[0].why, HasSubstr("freed"));
  request.edits = true;
  const auto kept = linesNaming(planLines(makePlan(request), {}), "smoothing");
  ASSERT_EQ(kept.size(), 1U);
  EXPECT_THAT(kept[0].why, HasSubstr("kept"));
  request.gradient_operator = "prewitt";
  EXPECT_THROW((void)makePlan(request), Error);
}

TEST(PlanLines, NameWhatWasLeftOut) {
  const auto lines = linesNaming(planLines(makePlan({}), {}), "picture");
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_FALSE(lines[0].done);
  EXPECT_FALSE(lines[0].why.empty());
}

}  // namespace plan_test
}  // namespace palpate
