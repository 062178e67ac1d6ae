// SPDX-License-Identifier: Apache-2.0
// The costs of features, with a program whose counts follow from its words.
#include "apps/plan/feature_cost.hpp"

#include <gmock/gmock.h>

#include "base/error.hpp"
#include "counting_program.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace feature_cost_test {

using testing::HasSubstr;

const FeatureCost& costOf(const SceneCounts& counts, const std::string& name) {
  for (const FeatureCost& cost : counts.costs)
    if (cost.feature->name == name) return cost;
  throw std::out_of_range(name);
}

SceneCounts countedWith(const CountingProgram& program, const Scene& scene, int rounds) {
  Progress progress;
  std::filesystem::create_directories(program.folder());
  return countScene(scene, rounds, program.folder(), progress, program.path());
}

Scene withFriction() {
  Scene scene;
  scene.volume = "phantom:sphere";
  scene.friction_static = 0.5;
  return scene;
}

TEST(FeatureCost, IsTheRunWithItLessTheRunWithout) {
  const CountingProgram program;
  const SceneCounts counts = countedWith(program, withFriction(), 1);
  EXPECT_EQ(counts.costs.size(), features().size());
  const FeatureCost& filter = costOf(counts, "filters");  // the scene lacks it
  EXPECT_FALSE(filter.is_in);
  EXPECT_EQ(filter.gpu_bytes, 500);
  EXPECT_EQ(filter.pipelines, 1);
  EXPECT_EQ(filter.dispatches.value, 5);
  EXPECT_EQ(filter.effect_runs, 0);
  EXPECT_FALSE(filter.start_ms.isClear());                   // of one run each
  const FeatureCost& friction = costOf(counts, "friction");  // the scene has it
  EXPECT_TRUE(friction.is_in);
  EXPECT_EQ(friction.effect_runs, 7);
  EXPECT_EQ(friction.tick_us.value, 1);
  EXPECT_FALSE(friction.tick_us.isClear());
  EXPECT_EQ(friction.gpu_bytes, 0);
  EXPECT_EQ(costOf(counts, "a picture").libraries, 1);  // the scene has it, and the others are switched without it
  EXPECT_TRUE(costOf(counts, "a picture").is_in);
  EXPECT_EQ(filter.libraries, 0);
  EXPECT_EQ(costOf(counts, "a journal").threads, 1);
  EXPECT_EQ(costOf(counts, "edits").threads, 0);
  EXPECT_EQ(counts.counts.effect_runs, 7);  // of the scene as it is
}

// Call c tells c ms. After a first run a round has R calls: the scene as it is, the scene without its picture, and that
// with each other feature switched. The texture fails in its first run and is not tried again. So the scene without a
// picture has calls 3, R + 3 and 2 R + 2; the filter comes three calls later, with 20 ms more.
TEST(FeatureCost, IsADifferenceOfMediansAndKnowsHowFarRunsOfTheSameSceneLieApart) {
  const CountingProgram program;
  const SceneCounts counts = countedWith(program, withFriction(), 3);
  const auto calls = static_cast<double>(features().size() + 1);
  EXPECT_EQ(program.called().size(), 1 + 3 * (features().size() + 1) - 2);
  const MeasuredDifference& start = costOf(counts, "filters").start_ms;
  EXPECT_EQ(start.value, 23);
  EXPECT_EQ(start.spread, 2 * calls - 1);
  EXPECT_FALSE(start.isClear());
  EXPECT_EQ(costOf(counts, "friction").tick_us.spread, 0);
  EXPECT_TRUE(costOf(counts, "friction").tick_us.isClear());
}

// As many rounds as fit into the time, but three at most, and never one alone.
TEST(FeatureCost, RoundsFitIntoATime) {
  EXPECT_EQ(roundsIn(60, 0.5, 20), 3);
  EXPECT_EQ(roundsIn(60, 1, 20), 3);
  EXPECT_EQ(roundsIn(60, 1.01, 20), 2);
  EXPECT_EQ(roundsIn(60, 1.5, 20), 2);
  EXPECT_EQ(roundsIn(60, 1.51, 20), 0);
  EXPECT_EQ(roundsIn(60, 1e9, 20), 0);
}

// This program takes no time, so three fit.
TEST(FeatureCost, WithoutANumberOfRoundsThereAreThree) {
  const CountingProgram program;
  Progress progress;
  const SceneCounts counts = countScene(withFriction(), {}, program.folder(), progress, program.path());
  EXPECT_EQ(counts.rounds, 3);
  EXPECT_EQ(counts.costs.size(), features().size());
}

TEST(FeatureCost, AFeatureThatTheSceneCannotHaveIsNoReasonToSayNothingOfTheOthers) {
  const CountingProgram program;
  const SceneCounts counts = countedWith(program, withFriction(), 1);
  EXPECT_THAT(costOf(counts, "texture").failure, HasSubstr("too rough"));
  EXPECT_EQ(costOf(counts, "recovery time").failure, "");
}

TEST(FeatureCost, WithoutRoundsTheSceneIsRunOnceAsItIs) {
  const CountingProgram program;
  const SceneCounts counts = countedWith(program, withFriction(), 0);
  EXPECT_TRUE(counts.costs.empty());
  EXPECT_EQ(counts.counts.effect_runs, 7);
  EXPECT_EQ(program.called().size(), 1U);
}

TEST(FeatureCost, ASceneThatDoesNotRunIsRefused) {
  const CountingProgram program;
  Scene scene = withFriction();
  scene.texture = "density";
  EXPECT_THAT(refusalOf([&] { (void)countedWith(program, scene, 1); }, Error::Code::kBadInput), HasSubstr("too rough"));
}

}  // namespace feature_cost_test
}  // namespace palpate
