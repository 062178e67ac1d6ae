// SPDX-License-Identifier: Apache-2.0
// What is recorded is what the reader of paths reads.
#include "apps/sculpt/tick_recording.hpp"

#include <csignal>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "apps/path/path_csv.hpp"
#include "temporary_folder.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace tick_recording_test {

TickRecord tickAt(std::int64_t tick, const Vec3& hip_W) {
  TickRecord record;
  record.tick = tick;
  for (int i = 0; i < 3; ++i) record.hip_W[i] = hip_W[i];
  return record;
}

// To the bit.
void expectAt(const TimedPoint& point, double time_s, const Vec3& p_W) {
  EXPECT_EQ(point.time_s, time_s);
  EXPECT_EQ(point.p_W, p_W);
}

TEST(TickRecording, IsReadBackAsAPath) {
  const TemporaryFolder folder;
  std::mt19937 random(4);
  std::uniform_real_distribution<double> metres(-2, 2);
  for (const double rate_hz : {10.0, 1000.0, 20000.0}) {
    const auto file = folder.path() / ("way" + std::to_string(rate_hz) + ".csv");
    std::vector<Vec3> way_W;
    TickRecording recording(file, rate_hz);
    for (int i = 0; i < 200; ++i) {
      way_W.emplace_back(metres(random), 1e-6 * metres(random), metres(random));
      recording.add(tickAt(5000 + i, way_W.back()));
    }
    EXPECT_EQ(recording.rows(), 200);
    EXPECT_DOUBLE_EQ(recording.seconds(), 200 / rate_hz);
    EXPECT_EQ(recording.file(), file);
    recording.close();
    const std::vector<TimedPoint> path = readPathCsv(file);
    ASSERT_EQ(path.size(), 200U);
    for (std::size_t i = 0; i < path.size(); ++i) expectAt(path[i], static_cast<double>(i) / rate_hz, way_W[i]);
  }
}

// Each from its tick on, and only its changes are told.
TEST(TickRecording, HoldsTheBrushes) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "way.csv";
  TickRecording recording(file, 1000);
  for (int i = 0; i < 50; ++i) {
    if (i == 10 || i == 15) recording.hold("remove:radius=0.002m");
    if (i == 20) recording.hold("");
    if (i == 40) recording.hold("add:radius=0.001m:mirror=x");
    recording.add(tickAt(i, Vec3(0.1, 0.2, 0.3)));
  }
  recording.close();
  const PathFile path = readPathFile(file);
  EXPECT_EQ(path.points.size(), 50U);
  ASSERT_EQ(path.brushes.size(), 3U);
  EXPECT_EQ(path.brushes[0].begin_s, 0.01);
  EXPECT_EQ(path.brushes[0].text, "remove:radius=0.002m");
  EXPECT_EQ(path.brushes[1].begin_s, 0.02);
  EXPECT_EQ(path.brushes[1].text, "");
  EXPECT_EQ(path.brushes[2].begin_s, 0.04);
  EXPECT_EQ(path.brushes[2].text, "add:radius=0.001m:mirror=x");
}

// A servo that was late leaves ticks out; more than ten in a row would be a hole in a path.
TEST(TickRecording, FillsInTicksThatWereLeftOut) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "way.csv";
  TickRecording recording(file, 1000);
  const Vec3 a_W(0.1, 0.2, 0.3), b_W(0.14, 0.2, 0.1);
  for (int i = 0; i < 20; ++i) recording.add(tickAt(i, a_W));
  recording.add(tickAt(59, b_W));
  recording.add(tickAt(60, b_W));
  recording.close();
  const std::vector<TimedPoint> path = readPathCsv(file);
  ASSERT_EQ(path.size(), 61U);
  expectAt(path[19], 0.019, a_W);
  EXPECT_TRUE(path[39].p_W.isApprox((a_W + b_W) / 2, 1e-15));
  EXPECT_TRUE(path[29].p_W.isApprox(0.75 * a_W + 0.25 * b_W, 1e-15));
  expectAt(path[59], 0.059, b_W);
  expectAt(path[60], 0.060, b_W);
}

TEST(TickRecording, TouchesNoFileThatIsThere) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "way.csv";
  std::ofstream(file) << "mine";
  EXPECT_THAT(refusalOf([&] { TickRecording recording(file, 1000); }, Error::Code::kIo),
              testing::HasSubstr("exists already"));
  std::string text;
  std::ifstream(file) >> text;
  EXPECT_EQ(text, "mine");
  EXPECT_THAT(refusalOf([&] { TickRecording recording(folder.path() / "none" / "way.csv", 1000); }, Error::Code::kIo),
              testing::HasSubstr("cannot be written"));
}

// What was written before a limit on the size of files stays, and is told.
TEST(TickRecording, SaysThatThereIsNoRoom) {
  const TemporaryFolder folder;
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto ignored = std::signal(SIGXFSZ, SIG_IGN);
  TickRecording recording(folder.path() / "way.csv", 1000);
  const rlimit small = {65536, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const std::string refusal = refusalOf(
      [&] {
        for (int i = 0; i < 10000; ++i) recording.add(tickAt(i, Vec3(0.123, 0.456, 0.789)));
      },
      Error::Code::kIo);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, ignored);
  EXPECT_THAT(refusal, testing::AllOf(testing::HasSubstr("way.csv"), testing::HasSubstr("cannot be written")));
  const std::vector<TimedPoint> path = readPathCsv(folder.path() / "way.csv");
  EXPECT_GT(path.size(), 1000U);
  EXPECT_LE(std::filesystem::file_size(folder.path() / "way.csv"), 65536U);
  for (const TimedPoint& point : path) EXPECT_EQ(point.p_W, Vec3(0.123, 0.456, 0.789));
}

}  // namespace tick_recording_test
}  // namespace palpate
