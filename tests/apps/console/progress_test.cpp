// SPDX-License-Identifier: Apache-2.0
#include "apps/console/progress.hpp"

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace palpate {
namespace progress_test {

// What a progress writes to a file, which is no terminal.
std::string written(double every_s, const std::function<void(Progress&)>& work) {
  std::FILE* stream = std::tmpfile();
  {
    Progress progress(stream, every_s);
    work(progress);
  }
  std::rewind(stream);
  std::string text(1 << 16, '\0');
  text.resize(std::fread(text.data(), 1, text.size(), stream));
  std::fclose(stream);
  return text;
}

// Somebody else shows it, and may end the work.
TEST(Progress, IsToldToWhoAsks) {
  std::vector<std::pair<std::string, double>> told;
  Progress progress([&](const std::string& stage, double done) {
    told.emplace_back(stage, done);
    if (done > 0.8) throw std::runtime_error("enough");
  });
  progress.stage("loading\na");
  progress.fraction(0.25);
  progress.done();
  progress.stage("writing b");
  EXPECT_THROW(progress.fraction(0.9), std::runtime_error);
  const std::vector<std::pair<std::string, double>> expected = {
      {"loading?a", 0}, {"loading?a", 0.25}, {"writing b", 0}, {"writing b", 0.9}};
  EXPECT_EQ(told, expected);
}

TEST(Progress, AStageIsALine) {
  EXPECT_EQ(written(1000,
                    [](Progress& p) {
                      p.stage("loading a");
                      p.fraction(0.5);
                      p.stage("writing b");
                      p.done();
                    }),
            "loading a ...\nwriting b ...\n");
}

// Nobody waits for half a minute before a screen that stands still.
TEST(Progress, ALongStageTellsHowFarItIs) {
  EXPECT_EQ(written(0,
                    [](Progress& p) {
                      p.stage("filtering");
                      p.fraction(0.25);
                      p.fraction(0.996);
                    }),
            "filtering ...\nfiltering: 25 % ...\nfiltering: 100 % ...\n");
}

// As often as is asked for and no more: a stage of many steps is no flood.
TEST(Progress, TellsNoMoreThanWasAskedFor) {
  double took_s = 0;
  const std::string text = written(0.05, [&](Progress& p) {
    const Stopwatch watch;
    p.stage("filtering");
    while (watch.seconds() < 0.22) p.fraction(watch.seconds() / 0.22);
    p.fraction(1);  // a machine that stops for long may have come to none before
    took_s = watch.seconds();
  });
  const auto lines = static_cast<double>(std::count(text.begin(), text.end(), '\n'));
  EXPECT_GE(lines, 2);                  // the stage and one more
  EXPECT_LE(lines, 1 + took_s / 0.05);  // 5, if nothing stops
}

// What a progress shows on a terminal, with a bar behind each piece of work. Empty where the system gives none.
std::string shown(const std::vector<std::function<void(Progress&)>>& works) {
  const int master = posix_openpt(O_RDWR | O_NOCTTY);
  if (master < 0 || grantpt(master) != 0 || unlockpt(master) != 0) return "";
  const int slave = open(ptsname(master), O_WRONLY | O_NOCTTY);
  if (slave < 0) return "";
  std::FILE* stream = fdopen(slave, "w");
  {
    Progress progress(stream, 1000);
    for (const auto& work : works) {
      work(progress);
      std::fputs("|", stream);
    }
  }
  std::fclose(stream);
  std::string text;
  char byte = 0;
  while (read(master, &byte, 1) == 1) text += byte;  // up to the terminal's end
  close(master);
  return text;
}

// One line, which is written anew when its words change, and wiped in the end.
TEST(Progress, OnATerminalIsOneLine) {
  const std::string text =
      shown({[](Progress& p) { p.stage("loading\na"); },                                       //
             [](Progress& p) { p.fraction(0.256); }, [](Progress& p) { p.fraction(0.2561); },  // the same in words
             [](Progress& p) { p.done(); },                                                    //
             [](Progress& p) { p.done(); },                                                    //
             [](Progress& p) { p.fraction(0.256); }});
  if (text.empty()) GTEST_SKIP() << "this system gives no terminal";
  const std::string wipe = "\r\033[K", line = "loading?a ...  26 %";
  EXPECT_EQ(text, wipe + "loading?a ...|" + wipe + line + "||" + wipe + "||" + wipe + line + "|" + wipe);
}

TEST(Progress, TheTimeLeftIsTold) {
  EXPECT_EQ(written(0,
                    [](Progress& p) {
                      p.stage("measuring");
                      p.fraction(0.25, 183);
                    }),
            "measuring ...\nmeasuring: 25 %, some 4 min left ...\n");
}

TEST(Progress, ARoughTimeIsInWholeUnitsAndNeverTooShort) {
  EXPECT_EQ(roughTime(0), "some 0 s");
  EXPECT_EQ(roughTime(0.1), "some 10 s");
  EXPECT_EQ(roughTime(61), "some 70 s");
  EXPECT_EQ(roughTime(121), "some 3 min");
  EXPECT_EQ(roughTime(7100), "some 119 min");
  EXPECT_EQ(roughTime(7300), "some 3 h");
}

}  // namespace progress_test
}  // namespace palpate
