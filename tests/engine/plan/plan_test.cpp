// SPDX-License-Identifier: Apache-2.0
#include "engine/plan/plan.hpp"

#include <algorithm>

#include <gmock/gmock.h>

#include "base/error.hpp"

namespace palpate {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<PlanLine> linesNaming(const std::vector<PlanLine>& lines, const std::string& word) {
  std::vector<PlanLine> found;
  std::copy_if(lines.begin(), lines.end(), std::back_inserter(found),
               [&](const PlanLine& line) { return line.what.find(word) != std::string::npos; });
  return found;
}

TEST(Plan, OfAnOrdinarySceneHasEveryPassInOrder) {
  EXPECT_THAT(makePlan(Scene{}).passes,
              ElementsAre(Pass::kUpload, Pass::kBrickBounds, Pass::kGradient, Pass::kWindow, Pass::kIsosurface));
}

TEST(Plan, WithoutAPictureHasNoRenderer) {
  Scene scene;
  scene.picture = false;
  const Plan plan = makePlan(scene);
  EXPECT_FALSE(plan.has(Pass::kIsosurface));
  EXPECT_TRUE(plan.has(Pass::kBrickBounds));  // it still chooses the bricks
}

// All bricks have gradients and nothing is drawn: nobody would read the bounds.
TEST(Plan, LeavesOutBoundsThatNobodyReads) {
  Scene scene;
  scene.gradient_all = true;
  EXPECT_TRUE(makePlan(scene).has(Pass::kBrickBounds));  // the renderer skips by them
  scene.picture = false;
  EXPECT_THAT(makePlan(scene).passes, ElementsAre(Pass::kUpload, Pass::kGradient, Pass::kWindow));
}

// 100 bricks: 60 stored leave out 40 x 2 KiB of density, 25 with gradients leave out 75 x 8 KiB of samples.
TEST(PlanLines, SayWhatWasSaved) {
  const auto lines = planLines(makePlan(Scene{}), {.bricks = 100, .stored_bricks = 60, .gradient_bricks = 25});
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
  Scene scene;
  scene.samples = "half";
  scene.gradient_operator = "sobel";
  const Plan plan = makePlan(scene);
  EXPECT_TRUE(plan.half_samples);
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
  Scene scene;
  scene.gradient_operator = "gaussian:0.8mm";
  EXPECT_THAT(makePlan(scene).passes, ElementsAre(Pass::kUpload, Pass::kBrickBounds, Pass::kSmoothing, Pass::kGradient,
                                                  Pass::kWindow, Pass::kIsosurface));
  const auto once = linesNaming(planLines(makePlan(scene), {}), "smoothing");
  ASSERT_EQ(once.size(), 1U);
  EXPECT_THAT(once[0].why, HasSubstr("freed"));
  EXPECT_FALSE(makePlan(scene).edits);
  scene.edit = "remove:radius=2mm";
  EXPECT_TRUE(makePlan(scene).edits);
  const auto kept = linesNaming(planLines(makePlan(scene), {}), "smoothing");
  ASSERT_EQ(kept.size(), 1U);
  EXPECT_THAT(kept[0].why, HasSubstr("kept"));
  scene.gradient_operator = "prewitt";
  EXPECT_THROW((void)makePlan(scene), Error);
}

TEST(PlanLines, NameWhatWasLeftOut) {
  Scene scene;
  scene.picture = false;
  for (const char* word : {"picture", "contact effects"}) {
    const auto lines = linesNaming(planLines(makePlan(scene), {}), word);
    ASSERT_EQ(lines.size(), 1U) << word;
    EXPECT_FALSE(lines[0].done) << word;
    EXPECT_FALSE(lines[0].why.empty()) << word;
  }
}

TEST(Plan, SaysWhetherAMeshIsExtractedAndObjectsAreThere) {
  const auto without = planLines(makePlan(Scene{}), {});
  ASSERT_EQ(linesNaming(without, "mesh").size(), 1U);
  EXPECT_FALSE(linesNaming(without, "mesh")[0].done);
  EXPECT_FALSE(linesNaming(without, "objects")[0].done);
  Scene scene;
  scene.objects.resize(2);
  const Plan plan = makePlan(scene, true);
  EXPECT_TRUE(plan.meshes);
  const auto with = planLines(plan, {.mesh_triangles = 1234});
  EXPECT_TRUE(linesNaming(with, "mesh")[0].done);
  EXPECT_EQ(linesNaming(with, "mesh")[0].what, "mesh of the isosurface, 1234 triangles");
  EXPECT_EQ(linesNaming(with, "objects")[0].what, "2 objects beside the volume");
}

}  // namespace
}  // namespace palpate
