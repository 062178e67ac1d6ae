// SPDX-License-Identifier: Apache-2.0
#include "apps/plan/scene_report.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace palpate {
namespace scene_report_test {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

const Feature& featureNamed(const std::string& name) {
  for (const Feature& feature : features())
    if (feature.name == name) return feature;
  throw std::out_of_range(name);
}

SceneReport sample() {
  RunCounts counts;
  counts.gpu = {
      .kernels = {{.name = "gradient", .constants = {{"kHalf", 0}, {"kRun", 8}}, .made_s = 0.0125, .dispatches = 3}},
      .buffers = {{.name = "window slot", .count = 3, .bytes = 1572864}},
      .submissions = 7,
      .peak_bytes = 2097152};
  counts.threads = {"palpate", "palpate", "engine", "servo", "llvmpipe-0"};
  counts.libraries = {"openvdb.so", "libc.so.6"};
  counts.effect_runs = 12;
  counts.wall_ms = 1500;
  const FeatureCost filters{.feature = &featureNamed("filters"),
                            .is_in = false,
                            .start_ms = {20, 3},
                            .tick_us = {0.01, 0.5},
                            .main_bytes = {-3145728, 10},
                            .dispatches = {4, 1},
                            .gpu_bytes = 1048576,
                            .pipelines = 1};
  const FeatureCost friction{
      .feature = &featureNamed("friction"), .is_in = true, .tick_us = {0.25, 0.1}, .effect_runs = 12};
  const FeatureCost texture{.feature = &featureNamed("texture"), .failure = "too rough"};
  return {.volume = "phantom:sphere",
          .isovalue = 0.5,
          .gpu = "llvmpipe",
          .lines = {{true, "60 of 100 bricks of density", "a brick that holds one value has no storage", 81920},
                    {false, "filters", "the scene names none", 0}},
          .passes = {{"upload", 0.002}, {"gradient", 0.0105}},
          .effects = "friction",
          .modules = {{.name = "itk", .ms = 18.25, .bytes = 4194304, .libraries = 40},
                      {.name = "openvdb", .ms = 35, .bytes = 1024, .libraries = 9},
                      {.name = "cairo", .failure = "it is gone"}},
          .counted = SceneCounts{.counts = counts, .costs = {filters, friction, texture}}};
}

TEST(SceneReport, SaysOfEachThingHowMuchAndWhatFor) {
  const std::string text = reportDocument(sample());
  for (const char* line :
       {"phantom:sphere at isovalue 0.5 on llvmpipe\n", "\n  do        60 of 100 bricks of density",
        "\n  leave     filters", "\nTime at the start: upload 2.0 ms, gradient 10.5 ms.\n",
        "| `gradient` | kHalf=0 kRun=8 | 12.5 | 3 | gradients of the bricks that need them |\n",
        "| window slot | 3 | 1.5 MiB | the samples around the tool", "at most 2 MiB at one time",
        "| `servo` | the force, tick by tick |\n", "| 2 more | the Vulkan driver and libraries |\n",
        "they ran 12 times:\n\n| effect | what for |\n|---|---|\n| friction | the tool sticks and slips |\n",
        "| `kRun` | rows of a brick that one invocation computes |\n", "| all others | yes | | | 0 | the C and",
        "2 shared libraries are loaded in all", "| itk | no | 18.2 | 4 MiB | 40 | volumes in NRRD",
        "| openvdb | yes | 35.0 | 1 KiB | 9 |", "| cairo | no | | | | pictures; it cannot be loaded: it is gone |\n",
        "| lacks | filters (gaussian:1) | +20.0 | - | +1 MiB | -3 MiB | +1 | +4 | 0 | 0 | the scene names none: the "
        "volume itself is felt |\n",
        "| has | friction | - | +0.25 | 0 | - | 0 | - | 0 | 0 | as the scene says |\n",
        "| lacks | texture (procedural) | | | | | | | | | the scene names none; not measured: too rough |\n"})
    EXPECT_THAT(text, HasSubstr(line));
}

TEST(SceneReport, WithoutACountedRunSaysWhy) {
  SceneReport report = sample();
  report.counted.reset();
  report.not_counted = "no path was found";
  const std::string text = reportDocument(report);
  EXPECT_THAT(text, HasSubstr("\nNothing was counted: no path was found.\n"));
  EXPECT_THAT(text, Not(HasSubstr("| pipeline")));
  const json found = json::parse(reportJson(report));
  EXPECT_EQ(found["counted"], nullptr);
  EXPECT_EQ(found["not_counted"], "no path was found");
  EXPECT_EQ(found["modules"][1]["loaded"], false);
}

TEST(SceneReport, WithoutEffectsAndMeasurementsSaysSo) {
  SceneReport report = sample();
  report.effects.clear();
  report.counted->costs.clear();
  const std::string text = reportDocument(report);
  EXPECT_THAT(text, HasSubstr("\nServo effects: none, as the scene names none.\n"));
  EXPECT_THAT(text, Not(HasSubstr("What each feature adds")));
  EXPECT_THAT(text, HasSubstr("\nWhat each feature costs was not measured; --rounds 3 runs"));
  EXPECT_THAT(text, HasSubstr("This run took 1.5 s."));
}

TEST(SceneReport, HasARowForEachEffect) {
  SceneReport report = sample();
  report.effects = "texture, friction, stiffness by density";
  const std::string text = reportDocument(report);
  EXPECT_THAT(
      text,
      HasSubstr("| texture | fine relief |\n| friction | the tool sticks and slips |\n| stiffness by density | "));
}

// One run of each tells no difference from chance.
TEST(SceneReport, OfOneRunShowsNoTimes) {
  SceneReport report = sample();
  FeatureCost& filters = report.counted->costs.front();
  filters.start_ms.spread = filters.main_bytes.spread = filters.dispatches.spread = std::nan("");
  const std::string text = reportDocument(report);
  EXPECT_THAT(text, HasSubstr("| lacks | filters (gaussian:1) | - | - | +1 MiB | - | +1 | - | 0 | 0 |"));
  EXPECT_EQ(json::parse(reportJson(report))["features"][0]["start_ms"]["spread"], nullptr);
}

TEST(SceneReport, IsThereForProgramsToTheLetter) {
  const json found = json::parse(reportJson(sample()));
  EXPECT_EQ(found["schema"], "palpate.plan/1");
  EXPECT_EQ(found["passes"][0], json::parse(R"({"done": true, "what": "60 of 100 bricks of density",
    "why": "a brick that holds one value has no storage", "saved_bytes": 81920})"));
  EXPECT_EQ(found["stages"][1], json::parse(R"({"name": "gradient", "seconds": 0.0105})"));
  EXPECT_EQ(found["counted"]["pipelines"][0], json::parse(R"({"name": "gradient", "constants": {"kHalf": 0, "kRun": 8},
    "made_ms": 12.5, "dispatches": 3, "why": "gradients of the bricks that need them"})"));
  EXPECT_EQ(found["counted"]["buffers"][0]["bytes"], 1572864);
  EXPECT_EQ(found["counted"]["peak_bytes"], 2097152);
  EXPECT_EQ(found["counted"]["submissions"], 7);
  EXPECT_EQ(found["counted"]["threads"].size(), 5U);
  EXPECT_EQ(found["counted"]["libraries"].size(), 2U);
  EXPECT_EQ(found["counted"]["effect_runs"], 12);
  EXPECT_EQ(found["modules"][0], json::parse(R"({"name": "itk", "loaded": false, "ms": 18.25, "bytes": 4194304,
    "libraries": 40, "failure": "", "why": "volumes in NRRD and MetaImage"})"));
  EXPECT_EQ(found["modules"][1]["loaded"], true);
  EXPECT_EQ(found["modules"][2]["failure"], "it is gone");
  EXPECT_EQ(found["features"][0], json::parse(R"({"name": "filters", "is_in": false,
    "why": "the scene names none: the volume itself is felt", "measured_with": "gaussian:1",
    "start_ms": {"value": 20, "spread": 3}, "tick_us": {"value": 0.01, "spread": 0.5},
    "main_bytes": {"value": -3145728, "spread": 10}, "gpu_bytes": 1048576, "pipelines": 1, "dispatches": {"value": 4, "spread": 1},
    "effect_runs": 0, "threads": 0, "libraries": 0})"));
  EXPECT_EQ(found["features"][1]["is_in"], true);
  EXPECT_EQ(found["features"][2]["not_measured"], "too rough");
}

}  // namespace scene_report_test
}  // namespace palpate
