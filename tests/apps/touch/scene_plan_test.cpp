// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/scene_plan.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "apps/scene/option_table.hpp"
#include "base/error.hpp"
#include "servo/algorithms/registry.hpp"

namespace palpate {
namespace scene_plan_test {

// The one line that names `word`.
PlanLine lineNaming(const std::vector<PlanLine>& lines, const std::string& word) {
  const auto names = [&](const PlanLine& line) { return line.what.find(word) != std::string::npos; };
  EXPECT_EQ(std::count_if(lines.begin(), lines.end(), names), 1) << word;
  const auto found = std::find_if(lines.begin(), lines.end(), names);
  return found == lines.end() ? PlanLine{} : *found;
}

std::vector<PlanLine> linesOf(const Scene& scene, std::size_t triangles = 0) {
  return scenePlanLines(scene, planFor(scene), {}, triangles);
}

TEST(ScenePlan, AsksTheEngineForWhatTheSceneSaysAndNothingElse) {
  const EngineRequest plain = planFor(Scene{}).request;
  EXPECT_EQ(plain.filter, "");
  EXPECT_EQ(plain.gradient_operator, "central");
  EXPECT_FALSE(plain.distance || plain.gradient_all || plain.half_samples || plain.edits);
  EXPECT_TRUE(plain.draws);
  Scene scene;
  scene.filter = "median:1";
  scene.field = "distance";
  scene.gradient_operator = "sobel";
  scene.samples = "half";
  scene.edit = "remove:radius=2mm";
  scene.picture = false;
  const EngineRequest asked = planFor(scene).request;
  EXPECT_EQ(asked.filter, "median:1");
  EXPECT_EQ(asked.gradient_operator, "sobel");
  EXPECT_TRUE(asked.distance && asked.half_samples && asked.edits);
  EXPECT_FALSE(asked.draws || asked.gradient_all);
}

// Gradients are computed where the isosurface is; what feels elsewhere needs them there, or it would feel nothing.
TEST(ScenePlan, AlgorithmsThatFeelAwayFromTheSurfaceGetGradientsThere) {
  Scene scene;
  for (const AlgorithmEntry& entry : algorithms()) {
    scene.algorithm = entry.name;
    EXPECT_EQ(planFor(scene).request.gradient_all, entry.name == "avila" || entry.name == "haptization") << entry.name;
  }
  scene.algorithm = "hri";
  scene.gradient_all = true;
  EXPECT_TRUE(planFor(scene).request.gradient_all);
  scene.algorithm = "nothing";
  EXPECT_THROW((void)planFor(scene), Error);
}

TEST(ScenePlan, SaysWhatTheServoLeavesOut) {
  const std::vector<PlanLine> lines = linesOf(Scene{});
  for (const char* word : {"mesh of", "objects beside", "contact effects"}) {
    EXPECT_FALSE(lineNaming(lines, word).done) << word;
    EXPECT_FALSE(lineNaming(lines, word).why.empty()) << word;
  }
}

TEST(ScenePlan, SaysWhatTheServoDoes) {
  Scene scene;
  scene.algorithm = "god-object";
  scene.objects.resize(2);
  scene.texture = "procedural";
  scene.friction_static = 0.5;
  const std::vector<PlanLine> lines = linesOf(scene, 1234);
  EXPECT_TRUE(lineNaming(lines, "mesh of").done);
  EXPECT_EQ(lineNaming(lines, "mesh of").what, "mesh of the isosurface, 1234 triangles");
  EXPECT_EQ(lineNaming(linesOf(scene), "mesh of").what, "mesh of the isosurface");
  EXPECT_TRUE(lineNaming(lines, "objects beside").done);
  EXPECT_EQ(lineNaming(lines, "objects beside").what, "2 objects beside the volume");
  EXPECT_TRUE(lineNaming(lines, "contact effects").done);
  EXPECT_EQ(lineNaming(lines, "contact effects").what, "contact effects: texture, friction");
  scene.objects.resize(1);
  EXPECT_EQ(lineNaming(linesOf(scene), "object beside").what, "1 object beside the volume");
}

// The range of the option is the engine's.
TEST(ScenePlan, TakesTheScenesWindow) {
  const auto& edges = std::get<IntegerOption>(optionOfKey("window")->value);
  EXPECT_EQ(edges.lowest, kLeastWindowEdge);
  EXPECT_EQ(edges.highest, kMostWindowEdge);
  Scene scene;
  EXPECT_EQ(planFor(scene).request.window_edge, kMostWindowEdge);
  scene.window_edge = 12;
  EXPECT_EQ(planFor(scene).request.window_edge, 12);
  scene.window_edge = kLeastWindowEdge - 1;
  EXPECT_THROW(static_cast<void>(planFor(scene)), Error);
}

}  // namespace scene_plan_test
}  // namespace palpate
