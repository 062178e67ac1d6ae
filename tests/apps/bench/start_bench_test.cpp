// SPDX-License-Identifier: Apache-2.0
// The bench's own work, with a program that only writes down how it was called: what is counted, in which order, and
// what a failing program does. No time is asserted but those that the program told.
#include "apps/bench/start_bench.hpp"

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "apps/rivals/scratch_folder.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace start_bench_test {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

// A program that adds a line with its words to a file. As a touch it leaves a summary in which each touch is one
// millisecond slower than the one before, and three libraries were loaded.
class Program {
 public:
  // `refused`: a word at which it fails.
  explicit Program(const std::string& refused = "no such word") {
    std::ofstream file(path());
    file << "#!/bin/sh\n"
         << "echo \"$*\" >> '" << calls() << "'\n"
         << "case \"$*\" in *'" << refused << "'*) exit 1;; esac\n"
         << "[ \"$1\" = touch ] || exit 0\n"
         << "while [ \"$1\" != --out ]; do shift; done\n"
         << "mkdir -p \"$2\"\n"
         << "touches=$(grep -c '^touch' '" << calls() << "')\n"
         << "echo '{\"servo\": {\"start_to_first_tick_ms\": '$touches'}, \"libraries\": [\"a\", \"b\", \"c\"], "
            "\"vulkan\": {\"device\": \"a device\"}}'"
         << " > \"$2/summary.json\"\n";
    file.close();
    fs::permissions(path(), fs::perms::owner_all);
  }

  [[nodiscard]] std::string path() const { return (folder_.path() / "program").string(); }
  // The first two words of each call.
  [[nodiscard]] std::vector<std::string> called() const {
    std::vector<std::string> words;
    std::ifstream file(calls());
    for (std::string line; std::getline(file, line);) {
      const std::size_t blank = line.find(' ');
      const std::size_t second = blank == std::string::npos ? blank : line.find(' ', blank + 1);
      words.push_back(line.substr(0, second));
    }
    return words;
  }

 private:
  [[nodiscard]] std::string calls() const { return (folder_.path() / "calls").string(); }
  ScratchFolder folder_;
};

BenchResult runWith(const Program& program, int rounds) {
  Progress progress;
  return runStartBench({.rounds = rounds, .program = program.path()}, progress);
}

// 3 files are made; then 8 jobs (6 of them touches) in each of 1 + 3 rounds.
constexpr std::size_t kFiles = 3, kJobs = 8, kTouches = 6, kRounds = 3;

TEST(StartBench, EveryRoundBeginsWithAnotherJobAndTheFirstRoundIsNotCounted) {
  const Program program;
  const BenchResult result = runWith(program, kRounds);
  const std::vector<std::string> calls = program.called();
  ASSERT_EQ(calls.size(), kFiles + (1 + kRounds) * kJobs);
  const auto firstOfRound = [&](std::size_t round) { return calls[kFiles + round * kJobs]; };
  EXPECT_EQ(firstOfRound(0), "--version");
  EXPECT_EQ(firstOfRound(1), "help");
  EXPECT_EQ(firstOfRound(2), "touch phantom:sphere");
  const auto rows = rowsOf(result, "start");
  ASSERT_EQ(rows.size(), kJobs);
  for (const BenchRow* row : rows) EXPECT_EQ(figureOf(*row, "rounds"), kRounds);
}

// Touch i of all told i ms. "touch phantom:sphere" is the first touch in the list of jobs, behind two others. Round 0
// does not count. Rounds 1 and 2 begin before it or with it, so it is their first touch; round 3 begins with the job
// after it, so it is the last.
TEST(StartBench, TheFirstTickIsWhatTheTouchesToldInTheRoundsThatCount) {
  const Program program;
  const BenchResult result = runWith(program, kRounds);
  const auto rows = rowsOf(result, "start", {{"job", "touch phantom:sphere"}});
  ASSERT_EQ(rows.size(), 1U);
  const std::vector<std::string> calls = program.called();
  std::vector<double> told;
  double touch = 0;
  for (std::size_t n = kFiles; n < calls.size(); ++n) {
    if (!calls[n].starts_with("touch")) continue;
    ++touch;
    const std::size_t round = (n - kFiles) / kJobs, job = (n - kFiles + round) % kJobs;
    if (round > 0 && job == 2) told.push_back(touch);
  }
  ASSERT_EQ(told.size(), kRounds);
  EXPECT_THAT(told, ElementsAre(kTouches + 1, 2 * kTouches + 1, 4 * kTouches));
  EXPECT_EQ(figureOf(*rows[0], "first_tick_median_ms"), told[1]);
  EXPECT_EQ(figureOf(*rows[0], "first_tick_quartile_1_ms"), told[0]);
  EXPECT_EQ(figureOf(*rows[0], "first_tick_quartile_3_ms"), told[2]);
  EXPECT_EQ(figureOf(*rows[0], "libraries"), 3);
}

TEST(StartBench, PromisesTheVersionAndTheFirstTickOfABareTouch) {
  const Program program;
  const BenchResult result = runWith(program, 1);
  EXPECT_EQ(result.vulkan_device, "a device");
  ASSERT_EQ(result.targets.size(), 2U);
  const auto version = rowsOf(result, "start", {{"job", "--version"}});
  EXPECT_EQ(result.targets[0].value, figureOf(*version.at(0), "wall_median_ms"));
  EXPECT_EQ(result.targets[0].bound, 10);
  const auto touch = rowsOf(result, "start", {{"job", "touch phantom:sphere"}});
  EXPECT_EQ(result.targets[1].value, figureOf(*touch.at(0), "first_tick_median_ms"));
  EXPECT_EQ(result.targets[1].bound, 150);
  EXPECT_THAT(startTable(result), HasSubstr("god-object"));
  EXPECT_THAT(logChartSvg(startCharts(result)), HasSubstr("touch sphere.nii"));
}

TEST(StartBench, AJobThatFailsIsNamed) {
  const Program program("god-object");
  EXPECT_THAT(refusalOf([&] { (void)runWith(program, 1); }, Error::Code::kDevice), HasSubstr("god-object"));
}

TEST(StartBench, AProgramThatIsNotThereIsToldAtOnce) {
  Progress progress;
  EXPECT_THAT(
      refusalOf([&] { (void)runStartBench({.rounds = 1, .program = "/no/such/program"}, progress); }, Error::Code::kIo),
      HasSubstr("no process"));
}

}  // namespace start_bench_test
}  // namespace palpate
