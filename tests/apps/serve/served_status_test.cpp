// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/served_status.hpp"

#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "servo/safety/faults.hpp"

namespace palpate {
namespace served_status_test {

using testing::HasSubstr;
using testing::Not;

std::map<std::string, double> figures(const ServedStatus& status, std::int64_t now_ns = 0) {
  const auto list = figuresOf(status, now_ns);
  return {list.begin(), list.end()};
}

TEST(ServedStatus, FiguresAreWhatTheyAreCalled) {
  ServedStatus status;
  status.servo = true;
  status.servos = 2;
  status.servo_process = getpid();
  status.pose.tick = 77;
  status.pose.force_W = Vec3(3, 0, 4);
  status.pose.normal_W = Vec3(0, 0, 1);
  status.pose.faults = 96;
  status.force_off = ForceOff::kClutched;
  status.pose_at_ns = 5'000'000;
  status.windows = 3;
  status.window_age_ns = 14'000'000;
  status.waiting_for_disk = 4;
  status.waiting = 5;
  status.edits = 6;
  status.refused = 7;
  status.undoable = 8;
  status.redoable = 9;
  status.unsaved = true;
  status.journal_bytes = 10;
  status.journal_failure = "the disk is full";
  status.lost_records = 15;
  status.engines = 11;
  status.gpu_bytes = 12;
  status.clients = 13;
  std::map<std::string, double> all = figures(status, 7'000'000);
  EXPECT_GT(all["engine_memory_bytes"], 1e6);
  EXPECT_NEAR(all["servo_memory_bytes"], all["engine_memory_bytes"], 1e6);  // it is this process
  all.erase("engine_memory_bytes");
  all.erase("servo_memory_bytes");
  const std::map<std::string, double> expected = {{"servo", 1},          {"servos", 2},           {"tick", 77},
                                                  {"pose_age_ms", 2},    {"window_age_ms", 14},   {"force_N", 5},
                                                  {"force_off", 1},      {"contact", 1},          {"faults", 96},
                                                  {"windows", 3},        {"waiting_for_disk", 4}, {"waiting", 5},
                                                  {"edits", 6},          {"refused", 7},          {"undoable", 8},
                                                  {"redoable", 9},       {"unsaved", 1},          {"journal_bytes", 10},
                                                  {"journal_failed", 1}, {"lost_records", 15},    {"engines", 11},
                                                  {"gpu_bytes", 12},     {"clients", 13}};
  EXPECT_EQ(all, expected);
}

TEST(ServedStatus, WithoutAServoThereIsNoAgeAndNoMemory) {
  ServedStatus status;
  status.servo_process = getpid();
  const std::map<std::string, double> all = figures(status, 1'000'000'000);
  EXPECT_EQ(all.at("servo"), 0);
  EXPECT_EQ(all.at("pose_age_ms"), 0);
  EXPECT_EQ(all.at("servo_memory_bytes"), 0);
  EXPECT_EQ(all.at("contact"), 0);
  status.force_off = ForceOff::kDisconnected;  // of the servo that was there
  EXPECT_EQ(figures(status, 1'000'000'000).at("force_off"), 0);
}

// A fault is counted when it begins, not as long as it lasts.
TEST(ServedStatus, CountsFaultsAsTheyBegin) {
  ServedStatus status;
  ToolPose pose;
  const auto note = [&](std::int64_t tick, std::uint32_t faults) {
    pose.tick = tick;
    pose.faults = faults;
    notePose(status, pose, 1, 1000 * tick);
  };
  const std::uint32_t stale = bit(ServoFault::kStaleWindow), limited = bit(ServoFault::kForceLimited);
  note(1, 0);
  note(2, stale);
  note(3, stale | limited);
  note(4, limited);
  note(5, stale | limited);
  const std::map<std::string, double> all = figures(status);
  EXPECT_EQ(all.at("fault_" + faultNames(stale)), 2);
  EXPECT_EQ(all.at("fault_" + faultNames(limited)), 1);
  EXPECT_FALSE(all.contains("fault_" + faultNames(bit(ServoFault::kOverrun))));
}

TEST(ServedStatus, APoseThatIsSeenAgainGrowsOld) {
  ServedStatus status;
  ToolPose pose;
  pose.tick = 5;
  pose.window_version = 12;
  notePose(status, pose, 10, 1000);
  EXPECT_EQ(status.windows, 3U);
  notePose(status, pose, 10, 9000);
  EXPECT_EQ(status.pose_at_ns, 1000);
  pose.tick = 6;
  pose.window_version = 4;  // of the engine before
  notePose(status, pose, 10, 9500);
  EXPECT_EQ(status.pose_at_ns, 9500);
  EXPECT_EQ(status.windows, 0U);
}

// Each sample belongs to a name that was described and typed before it, and names are what Prometheus allows.
TEST(MetricsText, IsPrometheusForm) {
  ServedStatus status;
  status.edits = 3;
  status.faults_begun[1] = 2;
  status.faults_begun[5] = 1;
  const std::string text = metricsText(figuresOf(status, 0));
  EXPECT_THAT(text, HasSubstr("# HELP palpate_edits edits made, undo and redo included\n# TYPE palpate_edits counter\n"
                              "palpate_edits 3\n"));
  EXPECT_THAT(text, HasSubstr("# TYPE palpate_force_N gauge\n"));
  EXPECT_THAT(text, HasSubstr("# TYPE palpate_faults_begun counter\npalpate_faults_begun{fault=\"stale-window\"} 2\n"));
  std::istringstream lines(text);
  std::string described, typed;
  const std::regex sample(R"(([a-zA-Z_:][a-zA-Z0-9_:]*)(\{fault="[a-z-]+"\})? -?[0-9.e+]+)");
  std::size_t samples = 0;
  for (std::string line; std::getline(lines, line);) {
    std::smatch parts;
    if (line.starts_with("# HELP ")) {
      described = line.substr(7, line.find(' ', 7) - 7);
    } else if (line.starts_with("# TYPE ")) {
      typed = line.substr(7, line.find(' ', 7) - 7);
      EXPECT_EQ(typed, described);
    } else {
      ASSERT_TRUE(std::regex_match(line, parts, sample)) << line;
      EXPECT_EQ(parts[1], typed);
      ++samples;
    }
  }
  EXPECT_EQ(samples, statusFigures().size() + 2);
  std::vector<std::string> counters;  // that only grow, as long as the service lives
  for (const StatusFigure& one : statusFigures())
    if (one.is_counter) counters.emplace_back(one.key);
  EXPECT_THAT(counters, testing::ElementsAre("servos", "tick", "windows", "edits", "refused", "engines"));
  EXPECT_THAT(metricsText({{"from a newer service", 1}}), Not(HasSubstr("newer")));
}

}  // namespace served_status_test
}  // namespace palpate
