// SPDX-License-Identifier: Apache-2.0
#include "apps/report/summary.hpp"

#include <fstream>
#include <limits>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/scene/option_table.hpp"
#include "sample_run.hpp"
#include "temporary_folder.hpp"

namespace palpate {
namespace summary_test {

using Json = nlohmann::ordered_json;

// Every key of a summary as docs/summary.md writes it: "servo.ticks", "stages[].name".
void collect(const Json& value, const std::string& name, std::set<std::string>& keys) {
  if (value.is_object()) {
    for (const auto& [key, item] : value.items()) collect(item, name.empty() ? key : name + "." + key, keys);
  } else if (value.is_array() && !value.empty() && value.front().is_object()) {
    collect(value.front(), name + "[]", keys);
  } else {
    keys.insert(name);
  }
}

std::set<std::string> documentedKeys() {
  std::ifstream in(PALPATE_DOCS "/summary.md");
  std::set<std::string> keys;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("| `")) keys.insert(line.substr(3, line.find('`', 3) - 3));
  }
  return keys;
}

TEST(Summary, HasExactlyTheDocumentedKeys) {
  std::set<std::string> keys;
  collect(makeSummary(sampleRun()), "", keys);
  std::set<std::string> documented = documentedKeys();
  for (const SceneOption& option : sceneOptions()) documented.insert(std::string("scene.") + option.key);
  EXPECT_THAT(keys, ::testing::ContainerEq(documented));
}

TEST(Summary, HoldsTheFiguresOfTheRun) {
  const Json s = makeSummary(sampleRun());
  EXPECT_EQ(s.begin().key(), "schema");
  EXPECT_EQ(s["schema"], "palpate.touch.summary/2");
  EXPECT_EQ(s["contact"]["ticks"], 3000);
  EXPECT_EQ(s["contact"]["time_s"], 3.0);
  EXPECT_NEAR(s["contact"]["depth_m"]["max"].get<double>(), 1.001e-3, 1e-9);
  EXPECT_EQ(s["servo"]["times_measured"], true);
}

// Every figure under its own name: no two are equal.
TEST(Summary, HoldsEveryFigureToTheLetter) {
  TouchRun run = sampleEditedRun();
  const Json s = makeSummary(run);
  EXPECT_EQ(s["volume"], Json::parse(R"({"name": "phantom:sphere?size=64", "format": "phantom",
    "size_voxel": [64, 65, 66], "spacing_m": [0.0005, 0.00075, 0.001],
    "minimum_density": -1, "maximum_density": 1, "isovalue_density": 0.25})"));
  EXPECT_EQ(s["contact"], Json::parse(R"({"ticks": 3000, "time_s": 3, "touches": 2, "first_s": 0, "way_m": 0.02,
    "force_N": {"count": 3000, "p50": 0.25, "p90": 0.3, "p99": 0.4, "p99_9": 0.45, "max": 0.5},
    "depth_m": {"count": 2999, "p50": 0.0005, "p90": 0.0006, "p99": 0.0007, "p99_9": 0.0008, "max": 0.001},
    "force_step_max_N": 0.125})"));
  EXPECT_EQ(s["path"], Json::parse(R"({"slide_lost_s": 0, "retreat_touches": 0, "retreat_ends_in_contact": false})"));
  Json servo = s["servo"];
  EXPECT_EQ(servo["realtime"], Json(run.realtime));
  servo.erase("realtime");
  EXPECT_EQ(servo, Json::parse(R"({"ticks": 4993, "time_s": 5, "times_measured": true,
    "start_to_first_tick_ms": 125, "late_ticks": 4,
    "skipped_ticks": 7, "faulty_ticks": 5, "windows_used": 251, "plane_age_max_ticks": 6,
    "loop_us_a_tick": null, "tick_cost_us": {"count": 4992, "p50": 2, "p90": 2.5, "p99": 3.25, "p99_9": 3.5, "max": 9},
    "lateness_us": {"count": 4991, "p50": 40, "p90": 50, "p99": 60, "p99_9": 65, "max": 70},
    "window_age_ms": {"count": 4990, "p50": 10, "p90": 15, "p99": 20, "p99_9": 21, "max": 22}})"));
  EXPECT_EQ(s["energy"], Json::parse(R"({"min_J": -1e-5, "end_J": 0.0015, "active_ticks": 8, "damped_ticks": 0})"));
  EXPECT_EQ(s["exact"], Json::parse(R"({"ticks": 2000, "slide_only": true, "vhip_median_voxel": 0.01,
    "vhip_p99_voxel": 0.05, "force_angle_median_deg": 0.3, "force_angle_p99_deg": 1.2,
    "force_error_median_N": 0.02, "force_error_p99_N": 0.04})"));
  EXPECT_EQ(s["edits"], Json::parse(R"({"count": 3, "published": 2,
    "edit_to_window_ms": {"count": 2, "p50": 1.5, "p90": 2.5, "p99": 2.5, "p99_9": 2.5, "max": 2.5},
    "journal_records": 3, "journal_saved": 2, "journal_bytes": 500, "journal_failure": "the disk is full",
    "refused": 1, "saves": 2, "save_failures": 4, "save_bytes": 2048, "save_version": 3,
    "save_s": {"count": 2, "p50": 0.25, "p90": 0.5, "p99": 0.5, "p99_9": 0.5, "max": 0.5},
    "save_failure": "it is full too", "content": "0000000000000abc", "added_m3": 2e-9})"));
  EXPECT_EQ(s["machine"], Json::parse(R"({"cpu": "Example CPU", "cores": 4, "memory_bytes": 8589934592,
    "kernel": "Linux 6.1", "os": "Debian GNU/Linux 12"})"));
  EXPECT_EQ(s["work"], Json::parse(R"({"kernels": [{"name": "gradient", "constants": ["kHalf=0", "kRun=8"],
                                                    "made_ms": 12.5, "dispatches": 3}],
                                       "buffers": [{"name": "window slot", "count": 3, "bytes": 1572864}],
                                       "submissions": 7, "peak_bytes": 2000000, "threads": ["palpate", "engine", "servo"],
                                       "effect_runs": 0})"));
  EXPECT_EQ(s["libraries"], Json::parse(R"(["libc.so.6", "openvdb.so"])"));
  EXPECT_EQ(s["stages"][1], Json::parse(R"({"name": "gradient", "seconds": 0.1})"));
  EXPECT_EQ(s["memory"][0], Json::parse(R"({"name": "bricks on the GPU", "bytes": 3145728})"));
  EXPECT_EQ(s["phases"][2], Json::parse(R"({"name": "slide", "begin_s": 2, "end_s": 4})"));
  EXPECT_EQ(s["device"]["kind"], "polhem-v1");
  EXPECT_EQ(s["device"]["force_off"], "none");
  EXPECT_EQ(s["device"]["figures"]["reports_lost"], 3);
  EXPECT_EQ(s["ended_early"], nullptr);
  EXPECT_EQ(s["scene"]["objects"].size(), 2U);
  run.ended_early = "stopped";
  run.scene.simulated_clock = true;
  EXPECT_EQ(makeSummary(run)["ended_early"], "stopped");
  run.loop_us_a_tick = 1.5;
  EXPECT_EQ(makeSummary(run)["servo"]["times_measured"], false);
  EXPECT_EQ(makeSummary(run)["servo"]["loop_us_a_tick"], 1.5);
  EXPECT_EQ(makeSummary(run)["servo"]["tick_cost_us"], nullptr);
  EXPECT_EQ(makeSummary(run)["servo"]["lateness_us"], nullptr);
}

// Swings are told only where they made the contact unstable.
TEST(Summary, HoldsTheStabilityToTheLetter) {
  TouchRun run = sampleRun();
  ContactStability& s = run.stability = {};
  s.verdict = ContactVerdict::kUnstable;
  s.source = ActivitySource::kField;
  s.given_J = 1;
  s.error_J = 2;
  s.stored_J = 3;
  s.share = 4;
  s.allowed_J = 5;
  s.bounces = 6;
  s.swing_m = 7;
  s.swing_hz = 8;
  s.unstable_from_s = 9;
  s.unstable_to_s = 10;
  const std::string before = R"("source": "field", "given_J": 1, "stored_J": 3, "share": 4, "error_J": 2,
    "allowed_J": 5, "bounces": 6, )";
  EXPECT_EQ(
      makeSummary(run)["stability"],
      Json::parse(R"({"verdict": "unstable", )" + before +
                  R"("unstable_from_s": 9, "unstable_to_s": 10, "swing_m": 7, "swing_hz": 8, "ended_by_servo": 0})"));
  s.verdict = ContactVerdict::kSlightlyActive;
  EXPECT_EQ(
      makeSummary(run)["stability"],
      Json::parse(
          R"({"verdict": "slightly-active", )" + before +
          R"("unstable_from_s": null, "unstable_to_s": null, "swing_m": null, "swing_hz": null, "ended_by_servo": 0})"));
}

// As a scene file has it: nested, in the units of screens, null where nothing was given.
TEST(Summary, HoldsTheSceneAsASceneFileHasIt) {
  TouchRun run = sampleRun();
  run.scene.plane_renewal_ticks = 7;
  run.scene.simulated_clock = true;
  run.scene.press_depth_m = 1.5e-3;
  run.scene.gpu_memory_bytes = std::uint64_t{512} << 20U;
  run.scene.stiffness_density = {{200, 0.3}, {700.5, 1}};
  const Json scene = makeSummary(run)["scene"];
  EXPECT_EQ(scene["servo"]["n"], 7);
  EXPECT_EQ(scene["servo"]["clock"], "simulated");
  EXPECT_EQ(scene["path"]["depth_mm"], 1.5);
  EXPECT_EQ(scene["gpu_memory"], "512MiB");
  EXPECT_EQ(scene["contact"]["stiffness_density"], Json({{200, 0.3}, {700.5, 1}}));
  EXPECT_EQ(scene["contact"]["texture"], "none");
  EXPECT_EQ(scene["path"]["slide_toward"], nullptr);
  EXPECT_EQ(scene["path"]["toward"], Json({0, 0, -1}));
  EXPECT_EQ(scene["haptization"]["density"], nullptr);
  EXPECT_EQ(makeSummary(sampleRun())["scene"]["gpu_memory"], nullptr);
}

// Every figure of the servo under its own name: all differ.
TEST(Summary, TellsLateFromSkippedTicks) {
  TouchRun run = sampleRun();
  run.records.erase(run.records.begin() + 100, run.records.begin() + 107);
  for (const std::size_t i : {50U, 99U, 300U}) run.records[i].faults |= bit(ServoFault::kOverrun);
  run.records[400].faults |= bit(ServoFault::kBeyondWindow);
  const Json servo = makeSummary(run)["servo"];
  EXPECT_EQ(servo["ticks"], 4993);
  EXPECT_EQ(servo["time_s"], 5.0);
  EXPECT_EQ(servo["late_ticks"], 3);
  EXPECT_EQ(servo["skipped_ticks"], 7);
  EXPECT_EQ(servo["faulty_ticks"], 4);
}

TEST(Summary, IsNullWhereNothingIsKnown) {
  TouchRun run = sampleRun();
  run.exact.reset();
  run.volume.isovalue = std::numeric_limits<double>::quiet_NaN();
  for (TickRecord& r : run.records) r.in_contact = false;
  const Json s = Json::parse(makeSummary(run).dump());
  EXPECT_TRUE(s["exact"].is_null());
  EXPECT_TRUE(s["contact"]["first_s"].is_null());
  EXPECT_TRUE(s["volume"]["isovalue_density"].is_null());
}

TEST(Summary, IsWrittenAsValidJsonEvenForABadName) {
  TemporaryFolder folder;
  TouchRun run = sampleRun();
  run.volume.name = "scan\xff\"\n";
  writeSummary(folder.path() / "s.json", run);
  const Json s = Json::parse(contentsOf(folder.path() / "s.json"));
  EXPECT_EQ(s["volume"]["name"], "scan\xEF\xBF\xBD\"\n");
}

// Figures of many records take seconds: what the run has of them is not computed again.
TEST(Summary, TakesTheFiguresThatTheRunHas) {
  TouchRun run = sampleRun();
  const RunFigures computed = figuresOf(run);
  run.figures = computed;
  run.figures->ticks = 42;
  EXPECT_EQ(makeSummary(run)["servo"]["ticks"], 42);
  run.figures.reset();
  EXPECT_EQ(makeSummary(run)["servo"]["ticks"], computed.ticks);
}

}  // namespace summary_test
}  // namespace palpate
