// SPDX-License-Identifier: Apache-2.0
// Plans in a volume of 5x5x5 bricks. The bricks that a plan lists are counted by hand: what begins in the bricks from a
// to b along each axis is (b - a + 1)^3 bricks.
#include "engine/service/edit_plan.hpp"

#include <tuple>

#include <gmock/gmock.h>

#include "editor_state.hpp"

namespace palpate {
namespace edit_plan_test {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

constexpr std::uint32_t kMiddle = (2 * 5 + 2) * 5 + 2;  // brick (2, 2, 2)

// All bricks hold -100, except where a test stores the middle one.
class Plans : public testing::Test {
 protected:
  static Volume volume(bool stored_middle) {
    return Volume::fromBricks({40, 40, 40}, lattice(), {}, [&](const Vec3i& brick, float* values) {
      std::fill_n(values, kBrickVoxels, -100.0F);
      if (!stored_middle || brick != Vec3i(2, 2, 2)) return true;
      values[7] = -99.0F;
      return false;
    });
  }
  static EditPlanner::Scope scopeOf(const BrickPool& pool, const SampleStore& store) {
    return {.pool = pool,
            .store = store,
            .filter_reach = {},
            .smoothing_reach = {},
            .gradient_reach = {1, 1},
            .isovalues = {30, 30}};
  }
  static BrushProfile profile() { return brushProfile(kIsovalue, -100, 200, lattice().spacing_m); }
  static EditPlan planOf(const EditPlanner::Scope& scope, std::vector<float> values) {
    const std::vector<BrickContent> bricks = {{kMiddle, std::move(values)}};
    return EditPlanner(scope, profile()).plan(bricks);
  }
  static std::vector<float> twoValues(float first, float others) {
    std::vector<float> values(kBrickVoxels, others);
    values[0] = first;
    return values;
  }

  gpu::Gpu gpu_{{}};
  gpu::Transfer transfer_{gpu_};
  BrickPool constant_{gpu_, transfer_, volume(false)};
  BrickPool stored_{gpu_, transfer_, volume(true)};
  SampleStore none_{gpu_, 125, {}};
};

// From one density to another on the same side of the isovalue, the isosurface stays where it is: no brick gets a slot
// for samples. Density at the isovalue is background.
TEST_F(Plans, AConstantBrickMayCrossWhereTheIsovalueLiesBetween) {
  const EditPlanner::Scope scope = scopeOf(constant_, none_);
  for (const float density : {-101.0F, -90.0F, 30.0F}) {
    const EditPlan plan = planOf(scope, {density});
    EXPECT_THAT(plan.altered, ElementsAre(kMiddle)) << density;
    EXPECT_THAT(plan.bounds_stale, SizeIs(8)) << density;  // cells that end in it begin in bricks 1 to 2
    EXPECT_THAT(plan.activity_unsure, IsEmpty()) << density;
    EXPECT_THAT(plan.unsampled, IsEmpty()) << density;
    EXPECT_THAT(plan.made_constant, IsEmpty()) << density;
    EXPECT_EQ(plan.new_bricks, 0U) << density;
    EXPECT_EQ(EditPlanner(scope, profile()).constantAfter(plan, kMiddle), density);
  }
  const EditPlan plan = planOf(scope, {31});
  EXPECT_THAT(plan.activity_unsure, SizeIs(27));  // those eight, and the far corners of their cells: bricks 1 to 3
  EXPECT_THAT(plan.unsampled, SizeIs(27));
  EXPECT_THAT(planOf(scope, {-100}).touched, IsEmpty());  // it holds that already
}

// The first of many densities says nothing about the others.
TEST_F(Plans, AStoredBrickMayCrossWhateverItHeld) {
  const EditPlan filled = planOf(scopeOf(constant_, none_), twoValues(-99, 200));
  EXPECT_THAT(filled.activity_unsure, SizeIs(27));
  EXPECT_EQ(filled.new_bricks, 1U);
  EXPECT_EQ(EditPlanner(scopeOf(constant_, none_), profile()).constantAfter(filled, kMiddle), std::nullopt);
  const EditPlan other = planOf(scopeOf(stored_, none_), twoValues(-99, 200));
  EXPECT_THAT(other.activity_unsure, SizeIs(27));
  EXPECT_EQ(other.new_bricks, 0U);
  EXPECT_THAT(other.made_constant, IsEmpty());
  const EditPlan emptied = planOf(scopeOf(stored_, none_), {-90});
  EXPECT_THAT(emptied.activity_unsure, SizeIs(27));
  EXPECT_EQ(emptied.new_bricks, 0U);
  EXPECT_THAT(emptied.made_constant, ElementsAre(kMiddle));
}

TEST_F(Plans, OnlyBricksWithSamplesHaveStaleGradients) {
  const SampleStore some(gpu_, 125, {0, 31, kMiddle});  // brick 31 is (1, 1, 1)
  const EditPlan crossing = planOf(scopeOf(constant_, some), {31});
  EXPECT_THAT(crossing.gradients_stale, ElementsAre(31, kMiddle));
  EXPECT_THAT(crossing.activity_unsure, SizeIs(27));
  EXPECT_THAT(crossing.unsampled, SizeIs(25));
  const EditPlan beside = planOf(scopeOf(constant_, some), {-90});
  EXPECT_THAT(beside.gradients_stale, ElementsAre(31, kMiddle));
  EXPECT_THAT(beside.unsampled, IsEmpty());
  EditPlanner::Scope all = scopeOf(constant_, none_);
  all.all_samples = true;
  const EditPlan everywhere = planOf(all, {31});
  EXPECT_THAT(everywhere.activity_unsure, IsEmpty());
  EXPECT_THAT(everywhere.gradients_stale, SizeIs(27));
}

// Where another isovalue is felt too, or a filtered field, the isosurface may be anywhere in what changes. A filter of
// 8 voxels carries voxels 16 to 23 to 8 to 31, bricks 1 to 3; bounds reach one voxel further down.
TEST_F(Plans, ReachAsFarAsFiltersAndSmoothingDo) {
  EditPlanner::Scope two = scopeOf(constant_, none_);
  for (const layout::IsovaluePair& isovalues : {layout::IsovaluePair{30, 20}, {20, 30}, {20, 20}}) {
    two.isovalues = isovalues;
    EXPECT_THAT(planOf(two, {-90}).activity_unsure, SizeIs(27)) << isovalues.felt << ' ' << isovalues.other;
  }
  EditPlanner::Scope filtered = scopeOf(constant_, none_);
  filtered.filter_reach = Vec3i(8, 8, 8);
  filtered.all_samples = true;
  const EditPlan wide = planOf(filtered, {-90});
  EXPECT_THAT(wide.altered, SizeIs(27));
  EXPECT_THAT(wide.smoothed, IsEmpty());
  EXPECT_THAT(wide.bounds_stale, SizeIs(64));      // bricks 0 to 3
  EXPECT_THAT(wide.gradients_stale, SizeIs(125));  // bricks 0 to 4
  filtered.all_samples = false;
  EXPECT_THAT(planOf(filtered, {-90}).activity_unsure, SizeIs(125));
  EditPlanner::Scope smoothed = scopeOf(constant_, none_);
  smoothed.smoothing_reach = Vec3i(8, 8, 8);
  smoothed.all_samples = true;
  const EditPlan soft = planOf(smoothed, {-90});
  EXPECT_THAT(soft.altered, ElementsAre(kMiddle));
  EXPECT_THAT(soft.smoothed, SizeIs(27));
  EXPECT_THAT(soft.bounds_stale, SizeIs(8));
  EXPECT_THAT(soft.gradients_stale, SizeIs(125));
}

// Commands of one kind run together, unless they read neighbours.
TEST_F(Plans, PhasesAreOfOneKind) {
  const Volume flat = volume(false);
  std::vector<EditCommand> commands;
  for (const EditKind kind : {EditKind::kAdd, EditKind::kAdd, EditKind::kRemove, EditKind::kSmooth, EditKind::kSmooth,
                              EditKind::kRemove, EditKind::kRemove, EditKind::kRemove})
    commands.push_back(brush(kind, flat, {20, 20, 20}, 4e-3));
  const EditPlan plan = EditPlanner(scopeOf(constant_, none_), profile()).plan(commands);
  using Phase = std::tuple<layout::uint, std::uint32_t, std::uint32_t>;
  std::vector<Phase> phases;
  for (const EditPhase& phase : plan.phases) phases.emplace_back(phase.kind, phase.first_command, phase.command_count);
  EXPECT_THAT(phases, ElementsAre(Phase(EDIT_ADD, 0, 2), Phase(EDIT_REMOVE, 2, 1), Phase(EDIT_SMOOTH, 3, 1),
                                  Phase(EDIT_SMOOTH, 4, 1), Phase(EDIT_REMOVE, 5, 3)));
}

// Planning changes nothing, and of an edit in the air nothing is left to do.
TEST_F(Plans, OfNoChangeAreEmpty) {
  const Volume flat = volume(false);
  const std::vector<EditCommand> air = {brush(EditKind::kRemove, flat, {20, 20, 20}, 4e-3)};
  const EditPlan plan = EditPlanner(scopeOf(constant_, none_), profile()).plan(air);
  EXPECT_THAT(plan.touched, IsEmpty());
  EXPECT_THAT(plan.bounds_stale, IsEmpty());
  EXPECT_THAT(plan.phases, SizeIs(1));
  EXPECT_THAT(plan.phases[0].tasks, IsEmpty());
}

TEST_F(Plans, ANeighbourIsOneThatSharesAFaceAndHasSamples) {
  const BrickGrid grid = constant_.grid();
  const auto beside = [&](const std::vector<std::uint32_t>& sampled) {
    return neighbourWithSamples(grid, SampleStore(gpu_, 125, sampled), kMiddle);
  };
  EXPECT_EQ(beside({}), std::nullopt);
  EXPECT_EQ(beside({kMiddle, kMiddle + 2, kMiddle + 6, kMiddle + 31}), std::nullopt);  // itself, farther, edges
  for (const std::uint32_t step : {1U, 5U, 25U}) {
    EXPECT_EQ(beside({kMiddle - step}), kMiddle - step);
    EXPECT_EQ(beside({kMiddle + step}), kMiddle + step);
    EXPECT_EQ(beside({kMiddle + step, kMiddle - step}), kMiddle - step);  // the first
  }
}

}  // namespace edit_plan_test
}  // namespace palpate
