// SPDX-License-Identifier: Apache-2.0
// Trials against `palpate touch`, which feels the same scene by itself.
#include "apps/tune/workbench.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/console/progress.hpp"
#include "apps/touch/force_error.hpp"
#include "apps/touch/scene_plan.hpp"
#include "apps/touch/touch_job.hpp"
#include "base/error.hpp"
#include "base/quantile.hpp"
#include "engine/field/statistics.hpp"
#include "engine/files/volume_file.hpp"
#include "servo/loop/run_figures.hpp"
#include "temporary_folder.hpp"

namespace palpate {
namespace workbench_test {

Scene shortScene(const std::string& volume) {
  Scene scene;
  scene.volume = volume;
  scene.duration_s = 0.5;
  scene.simulated_clock = true;
  scene.picture = false;
  scene.trace = false;
  return scene;
}

class WorkbenchTest : public testing::Test {
 protected:
  // What `palpate touch` makes of a scene.
  TouchRun touched(Scene scene) const {
    scene.out = (folder_.path() / "out").string();
    Progress quiet(nullptr);
    TouchRun run = runTouchJob(scene, "", "", quiet);
    EXPECT_TRUE(run.loop_us_a_tick.value_or(0) > 0);
    return run;
  }
  static std::vector<TickRecord> slideOf(const TouchRun& run) {
    std::vector<TickRecord> slide = run.records;
    std::erase_if(slide, [&](const TickRecord& record) { return !inSlide(record.time_s, run.phases); });
    return slide;
  }
  static Workbench bench(const Scene& scene) {
    Progress quiet(nullptr);
    return {scene, quiet};
  }
  TemporaryFolder folder_;
};

// Errors are the same but for roundings of positions in a window that begins elsewhere, some 1e-16 m times 500 N/m.
TEST_F(WorkbenchTest, FeelsWhatTouchFeels) {
  const Candidate candidates[] = {{"central", "", "float", 5, 32},
                                  {"sobel", "", "half", 1, 12},
                                  {"gaussian:1", "gaussian:1", "float", 8, 16},
                                  {"central", "gaussian:0.7", "float", 3, 24}};
  for (const char* volume : {"phantom:sphere?size=32&noise=0.05", "phantom:knot?size=40"}) {
    for (const bool spring : {false, true}) {
      Scene scene = shortScene(volume);
      scene.spring_hand = spring;
      Workbench bench = this->bench(scene);
      EXPECT_EQ(bench.whyNotExact(), "");
      for (const Candidate& candidate : candidates) {
        SCOPED_TRACE(std::string(volume) + " " + candidate.filter + (spring ? " spring" : " rigid"));
        const Trial kept = bench.feel(candidate), again = bench.feel(candidate), fresh = bench.feelAnew(candidate);
        const TouchRun touched = this->touched(bench.sceneOf(candidate));
        const std::vector<TickRecord> slide = slideOf(touched);
        const auto felt =
            std::ranges::count_if(slide, [](const TickRecord& r) { return r.in_contact && forceOf(r) > 0; });
        ASSERT_GT(felt, 0);
        for (const Trial& trial : {kept, again, fresh}) {
          EXPECT_NEAR(trial.error_N, touched.exact->force_error_p99_N.value_or(-1), 1e-9);
          // These surfaces are smooth, so their distance is known at every tick. Where damping leaves no force, a
          // spring that leaves the contact has no error.
          EXPECT_EQ(trial.contact_share, static_cast<double>(felt) / static_cast<double>(slide.size()));
          EXPECT_EQ(trial.faulty_ticks, 0);
          EXPECT_GT(trial.loop_us, 0);
        }
      }
    }
  }
}

// Only another filter fixes the path, and only what the scene leaves open.
TEST_F(WorkbenchTest, FixesThePathForAnotherFilter) {
  Scene scene = shortScene("phantom:sphere?size=32");
  scene.press_depth_m = 0.7e-3;
  Workbench bench = this->bench(scene);
  Candidate own = candidateOf(scene);
  own.n = 1;
  EXPECT_FALSE(bench.sceneOf(own).path_start_W);
  own.filter = "gaussian:1";
  const Scene fixed = bench.sceneOf(own);
  EXPECT_TRUE(fixed.path_start_W && fixed.path_slide && fixed.slide_length_m && fixed.approach_m);
  EXPECT_EQ(fixed.press_depth_m, 0.7e-3);
}

// A ball beside the volume: nothing exact is known. The truest settings are then their own truth; an older plane is
// not. One of n = 21 is 20 ticks old at its end, and the tool is s further on. A surface of radius R has left the plane
// there by s^2 / 2 R, times K. The knot lies within its volume, so R is taken as half its edge, 20 mm. Of the ticks one
// in 21 is so old, which is more than the percentile leaves out. s is the median way of 20 ticks.
TEST_F(WorkbenchTest, ComparesWithTheTruestSettingsWhereNothingIsExact) {
  for (const bool spring : {false, true}) {
    Scene scene = shortScene("phantom:knot?size=40");
    scene.spring_hand = spring;
    scene.objects.emplace_back();
    scene.objects.back().kind = ObjectKind::kSphere;
    scene.objects.back().position_W = Vec3(1, 1, 1);
    Workbench bench = this->bench(scene);
    EXPECT_EQ(bench.whyNotExact(), "the scene has objects");
    const Candidate truest{"central", "", "float", 1, 32}, older{"central", "", "float", 21, 32};
    EXPECT_NEAR(bench.feel(truest).error_N, 0, 1e-9) << spring;
    const std::vector<TickRecord> slide = slideOf(touched(bench.sceneOf(older)));
    ASSERT_GT(slide.size(), 100U);
    std::vector<double> ways_m;
    for (std::size_t i = 20; i < slide.size(); ++i)
      ways_m.push_back((asVec3(slide[i].hip_W) - asVec3(slide[i - 20].hip_W)).norm());
    const double way_m = median(ways_m);
    EXPECT_GT(bench.feel(older).error_N, stiffnessOf(scene) * way_m * way_m / (2 * 20e-3)) << spring;
    EXPECT_NEAR(bench.feelAnew(truest).error_N, 0, 1e-9) << spring;
  }
}

// Without room, the engine for the truth drives out that of the trial whose truth it is.
TEST_F(WorkbenchTest, FeelsTheSameWithoutRoomForEngines) {
  Scene scene = shortScene("phantom:knot?size=40");
  scene.objects.emplace_back();
  scene.objects.back().kind = ObjectKind::kSphere;
  scene.objects.back().position_W = Vec3(1, 1, 1);
  Progress quiet(nullptr);
  Workbench roomy(scene, quiet), narrow(scene, quiet, {.engines = 8, .share = 0});
  Workbench single(scene, quiet, {.engines = 1});
  const Candidate candidate{"central", "", "half", 21, 16};
  const Trial usual = roomy.feel(candidate);
  for (Workbench* bench : {&narrow, &single}) {
    const Trial trial = bench->feel(candidate);
    EXPECT_EQ(trial.error_N, usual.error_N);
    EXPECT_EQ(trial.memory_bytes, usual.memory_bytes);
    EXPECT_GT(trial.start_ms, 0);
    EXPECT_EQ(bench->feelAnew(candidate).memory_bytes, usual.memory_bytes);
  }
}

// A device that is not there is no matter: it is not opened.
TEST_F(WorkbenchTest, FeelsWithTheSimulatedDevice) {
  Scene scene = shortScene("phantom:sphere?size=32");
  const Candidate own = candidateOf(scene);
  const double usual_N = bench(scene).feel(own).error_N;
  scene.device = "of somebody";
  Workbench bench = this->bench(scene);
  EXPECT_EQ(bench.feel(own).error_N, usual_N);
  EXPECT_EQ(bench.sceneOf(own).device, "of somebody");
}

// The least memory in which halves fit is too little for floats, whose samples take twice as much.
TEST_F(WorkbenchTest, FloatsThatDoNotFitAreAChoiceThatCannotBe) {
  for (const bool exact : {true, false}) {
    Scene scene = shortScene("phantom:sphere?size=48");
    scene.samples = "half";
    if (!exact) {
      scene.objects.emplace_back();
      scene.objects.back().kind = ObjectKind::kSphere;
      scene.objects.back().position_W = Vec3(1, 1, 1);
    }
    Progress quiet(nullptr);
    const Volume volume = loadVolume(scene.volume);
    Plan plan = planFor(scene);
    plan.request.gradients_as_needed = false;  // a budget must hold all that the tool may come near
    const Engine engine(volume, plan, static_cast<float>(defaultIsovalue(volume)), "");
    scene.gpu_memory_bytes = engine.budgetedBytes();
    Workbench bench = this->bench(scene);
    const Candidate half = candidateOf(scene);
    Candidate floats = half;
    floats.samples = "float";
    EXPECT_EQ(bench.feel(half).impossible, "");
    EXPECT_NE(bench.feel(floats).impossible, "");
    EXPECT_EQ(bench.feelAnew(half).impossible, "");
    EXPECT_EQ(bench.truthSamples(), exact ? "float" : "half");
  }
}

TEST_F(WorkbenchTest, SaysWhatOnlyACandidateCannotAndThrowsWhatTheSceneCannot) {
  const Scene scene = shortScene("phantom:sphere?size=24");
  Workbench bench = this->bench(scene);
  Candidate other = candidateOf(scene);
  other.filter = "gaussian:1000";
  EXPECT_NE(bench.feel(other).impossible, "");
  Scene wrong = scene;
  wrong.filter = "gaussian:1000";
  Workbench of_wrong = this->bench(wrong);
  EXPECT_THROW(static_cast<void>(of_wrong.feel(candidateOf(wrong))), Error);
}

}  // namespace workbench_test
}  // namespace palpate
