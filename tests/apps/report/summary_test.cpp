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
