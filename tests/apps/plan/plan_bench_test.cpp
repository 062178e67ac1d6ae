// SPDX-License-Identifier: Apache-2.0
// The bench's own work, with a program whose counts follow from its words.
#include "apps/plan/plan_bench.hpp"

#include <algorithm>
#include <memory>

#include <gmock/gmock.h>

#include "apps/plan/feature.hpp"
#include "base/error.hpp"
#include "counting_program.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace plan_bench_test {

using testing::HasSubstr;

// Nothing that this program refuses is a step of the ladder but the texture, which stands for a scene that fails.
TEST(PlanBench, ASceneThatFailsEndsItWithItsReason) {
  const CountingProgram program;
  Progress progress;
  EXPECT_THAT(refusalOf([&] {
                (void)runPlanBench({.rounds = 1, .volume = "phantom:sphere", .program = program.path()}, progress);
              }),
              HasSubstr("too rough"));
}

// One bench, whose result the tests share: it calls the program a hundred times.
class PlanBenchRuns : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    program_ = std::make_unique<CountingProgram>();
    std::filesystem::permissions(program_->path(), std::filesystem::perms::owner_all);
    Progress progress;
    result_ = runPlanBench({.rounds = 2, .volume = "phantom:sphere", .program = gentle()}, progress);
    calls_ = program_->called().size();
  }
  static void TearDownTestSuite() { program_.reset(); }
  // The same program, which bears a texture too.
  [[nodiscard]] static std::string gentle() {
    const std::string path = program_->path() + "_gentle";
    std::ifstream from(program_->path());
    std::ofstream to(path);
    for (std::string line; std::getline(from, line);)
      if (line.find("too rough") == std::string::npos) to << line << '\n';
    to.close();
    std::filesystem::permissions(path, std::filesystem::perms::owner_all);
    return path;
  }
  inline static std::unique_ptr<CountingProgram> program_;
  inline static BenchResult result_;
  inline static std::size_t calls_ = 0;  // of the program, for that result
};

TEST_F(PlanBenchRuns, ClimbsFromTheBareTouchToEverything) {
  const auto adding = static_cast<std::size_t>(std::ranges::count_if(features(), &Feature::adds));
  const BenchRows ladder = rowsOf(result_, "ladder");
  const BenchRows alone = rowsOf(result_, "alone");
  ASSERT_EQ(ladder.size(), 1 + adding);
  ASSERT_EQ(alone.size(), features().size());
  EXPECT_EQ(calls_, 3 * (ladder.size() + alone.size()));  // a round more, to warm up
  const BenchRow& bare = *ladder.front();
  const BenchRow& all = *ladder.back();
  EXPECT_EQ(textOf(bare, "feature"), "bare touch");
  EXPECT_EQ(result_.vulkan_device, "a device");
  EXPECT_EQ(textOf(bare, "volume"), "phantom:sphere");
  EXPECT_EQ(figureOf(bare, "runs"), 2);
  EXPECT_EQ(figureOf(bare, "pipelines"), 2);
  EXPECT_EQ(figureOf(bare, "dispatches"), 7);
  EXPECT_EQ(figureOf(bare, "effect_runs"), 0);
  EXPECT_EQ(figureOf(bare, "libraries"), 2);
  EXPECT_EQ(figureOf(bare, "threads"), 2);
  EXPECT_EQ(figureOf(bare, "tick_median_us"), 2);
  EXPECT_EQ(figureOf(bare, "main_peak_MiB"), 3);
  EXPECT_EQ(figureOf(all, "pipelines"), 3);
  EXPECT_EQ(figureOf(all, "dispatches"), 12);
  EXPECT_EQ(figureOf(all, "effect_runs"), 7);
  EXPECT_EQ(figureOf(all, "libraries"), 3);
  EXPECT_EQ(figureOf(all, "threads"), 3);
  EXPECT_EQ(figureOf(all, "tick_median_us"), 3);
  EXPECT_EQ(figureOf(*rowsOf(result_, "alone", {{"feature", "filters"}}).at(0), "effect_runs"), 0);
}

// Without a round to warm up each scene is run once.
TEST_F(PlanBenchRuns, UsesTheVulkanDeviceThatIsAskedFor) {
  const std::size_t before = program_->called().size();
  Progress progress;
  static_cast<void>(runPlanBench(
      {.rounds = 1, .warms_up = false, .volume = "phantom:sphere", .gpu = "that one", .program = gentle()}, progress));
  const std::vector<std::string> calls = program_->called();
  ASSERT_GT(calls.size(), before);
  for (std::size_t i = before; i < calls.size(); ++i) EXPECT_THAT(calls[i], HasSubstr("gpu = \"that one\""));
}

TEST_F(PlanBenchRuns, AQuickOneRunsEachSceneOnce) {
  PlanBenchRequest request = PlanBenchRequest::quick();
  request.volume = "phantom:sphere";
  request.program = gentle();
  const std::size_t before = program_->called().size();
  Progress progress;
  const BenchResult quick = runPlanBench(request, progress);
  EXPECT_EQ(program_->called().size() - before, rowsOf(quick, "ladder").size() + rowsOf(quick, "alone").size());
  EXPECT_EQ(figureOf(*rowsOf(quick, "ladder").front(), "runs"), 1);
  EXPECT_EQ(quick.targets.size(), 2U);
}

TEST_F(PlanBenchRuns, PromisesLittleMemoryAndASoonStart) {
  ASSERT_EQ(result_.targets.size(), 2U);
  EXPECT_THAT(result_.targets[0].name, HasSubstr("GPU memory of a bare touch / of everything on, phantom:sphere"));
  EXPECT_DOUBLE_EQ(result_.targets[0].value, 1000.0 / 1500);
  EXPECT_EQ(result_.targets[0].bound, 1.0 / 5);
  const BenchRows ladder = rowsOf(result_, "ladder");
  EXPECT_DOUBLE_EQ(result_.targets[1].value,
                   figureOf(*ladder.front(), "start_median_ms") / figureOf(*ladder.back(), "start_median_ms"));
  EXPECT_EQ(result_.targets[1].bound, 1.0 / 3);
}

TEST_F(PlanBenchRuns, IsATableAndAChart) {
  const std::string table = planTable(result_);
  EXPECT_THAT(table, HasSubstr("each with all above it, phantom:sphere"));
  EXPECT_THAT(table, HasSubstr("each alone"));
  // The filter takes more memory. The call's number is its time, so steps of the ladder after it go unnamed.
  const std::string chart = logChartSvg(planCharts(result_));
  EXPECT_THAT(chart, HasSubstr(">filters<"));
  EXPECT_THAT(chart, HasSubstr(">bare touch<"));
}

}  // namespace plan_bench_test
}  // namespace palpate
