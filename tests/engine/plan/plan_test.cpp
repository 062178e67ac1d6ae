// SPDX-License-Identifier: Apache-2.0
#include "engine/plan/plan.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "base/error.hpp"

namespace palpate {
namespace plan_test {

using testing::Contains;
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
              ElementsAre(Pass::kUpload, Pass::kBrickBounds, Pass::kGradient, Pass::kWindow));
}

TEST(Plan, WithoutAPictureStillHasBounds) {
  const Plan plan = makePlan({});
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
  EXPECT_EQ(plan.gradient.kind.name, "sobel");
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

// Every line as a user reads it; "-" is what was left out. A brick of density takes 2 KiB, one of samples 8, as
// halves 4.
std::vector<std::string> wholeLines(const EngineRequest& request) {
  std::vector<std::string> texts;
  const PlanFacts facts{.bricks = 100, .stored_bricks = 60, .filtered_bricks = 70, .gradient_bricks = 25};
  for (const PlanLine& line : planLines(makePlan(request), facts))
    texts.push_back(fmt::format("{} {} | {} | {}", line.done ? "+" : "-", line.what, line.why, line.saved_bytes));
  return texts;
}

TEST(PlanLines, SayHowLargeTheWindowIs) {
  EXPECT_THAT(wholeLines({.window_edge = 12}),
              Contains("+ window of up to 12x12x12 samples around the tool, three slots | what the servo reads | 0"));
}

TEST(PlanLines, AreWholeAndInOrder) {
  const std::string density =
      "+ 60 of 100 bricks of density | a brick that holds one value has a page and no storage | 81920";
  const std::string window =
      "+ window of up to 32x32x32 samples around the tool, three slots | what the servo reads | 0";
  const std::string no_filters = "- filters | the scene names none: the volume itself is felt | 122880";
  const std::string floats = "+ samples as floats, 16 bytes a voxel | halves save half: --samples half | 0";
  const std::string no_picture = "- isosurface picture | not asked for (--picture off) | 0";
  const std::string all = "every brick: --gradient all, or an algorithm that feels away from the isosurface | 0";
  EXPECT_THAT(wholeLines({}), ElementsAre(density, no_filters,
                                          "+ gradient of 25 of 100 bricks: central | "
                                          "those that the isosurface crosses, and their halo | 614400",
                                          floats, window, no_picture));
  EXPECT_THAT(wholeLines({.gradient_all = true}),
              ElementsAre(density, no_filters, "+ gradient of 25 of 100 bricks: central | " + all, floats, window,
                          no_picture, "- brick bounds | every brick has gradients and nothing is drawn | 0"));
  EXPECT_THAT(wholeLines({.filter = "median:1",
                          .gradient_all = true,
                          .gradient_operator = "gaussian:0.8mm",
                          .half_samples = true,
                          .other_isovalues = true,
                          .draws = true}),
              ElementsAre(density,
                          "+ filters: median:1; 70 of 100 bricks | "
                          "as the scene says; a neighbourhood of one density stays one | 61440",
                          "+ smoothing of the whole field | "
                          "the operator takes its gradient; kept, since the isovalue may change | 0",
                          "+ gradient of 25 of 100 bricks: gaussian | " + all,
                          "+ samples as halves, 8 bytes a voxel | "
                          "--samples half: true to 2^-11 of the distance from the isovalue | 102400",
                          window, "+ isosurface picture | view.png and report.html show it | 0"));
}

// Whatever changes samples, or reads them all, needs them all.
TEST(Plan, ComputesGradientsAsNeededOnlyWhereNothingElseAsksForThem) {
  EXPECT_FALSE(makePlan({}).gradientsAsNeeded());  // nobody asked for it
  EngineRequest request{.gradients_as_needed = true};
  EXPECT_TRUE(makePlan(request).gradientsAsNeeded());
  request.draws = true;
  request.filter = "median:1";
  request.half_samples = true;
  EXPECT_TRUE(makePlan(request).gradientsAsNeeded());
  for (bool EngineRequest::*other :
       {&EngineRequest::edits, &EngineRequest::other_isovalues, &EngineRequest::gradient_all}) {
    EngineRequest more = request;
    more.*other = true;
    EXPECT_FALSE(makePlan(more).gradientsAsNeeded());
  }
  request.gradient_operator = "gaussian:1";
  EXPECT_FALSE(makePlan(request).gradientsAsNeeded());
  const auto lines = linesNaming(
      planLines(makePlan({.gradients_as_needed = true}), {.bricks = 100, .stored_bricks = 60, .gradient_bricks = 25}),
      "gradient");
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].what, "gradient of up to 25 of 100 bricks: central");
  EXPECT_EQ(lines[0].why, "those that the isosurface crosses, and their halo, each when the tool first comes near");
  EXPECT_EQ(lines[0].saved_bytes, 75U * 8192U);
}

TEST(Plan, NamesEveryPass) {
  std::vector<std::string> names;
  for (const Pass pass :
       {Pass::kUpload, Pass::kFilter, Pass::kBrickBounds, Pass::kSmoothing, Pass::kGradient, Pass::kWindow})
    names.emplace_back(passName(pass));
  EXPECT_THAT(names, ElementsAre("upload", "filter", "brick bounds", "smoothing", "gradient", "window"));
}

TEST(PlanLines, NameWhatWasLeftOut) {
  const auto lines = linesNaming(planLines(makePlan({}), {}), "picture");
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_FALSE(lines[0].done);
  EXPECT_FALSE(lines[0].why.empty());
}

}  // namespace plan_test
}  // namespace palpate
