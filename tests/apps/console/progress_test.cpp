// SPDX-License-Identifier: Apache-2.0
#include "apps/console/progress.hpp"

#include <algorithm>
#include <functional>

#include <gtest/gtest.h>

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
  const std::string text = written(0.05, [](Progress& p) {
    p.stage("filtering");
    const Stopwatch watch;
    while (watch.seconds() < 0.22) p.fraction(watch.seconds() / 0.22);
  });
  const auto lines = std::count(text.begin(), text.end(), '\n');
  EXPECT_GE(lines, 2);  // the stage and, on a machine that stops for long, one more
  EXPECT_LE(lines, 5);  // and 0.22 / 0.05 = 4
}

}  // namespace progress_test
}  // namespace palpate
