// SPDX-License-Identifier: Apache-2.0
// apps/console/progress.hpp: tells a waiting person what is going on, on stderr: one line that is rewritten on a
// terminal, a line a stage elsewhere, and one every few seconds of a long stage. One thread.
#pragma once

#include <cstdio>
#include <string>

#include "base/stopwatch.hpp"

namespace palpate {

class Progress {
 public:
  // `every_s`: where there is no terminal, how often the fraction of a long stage is told [s].
  explicit Progress(std::FILE* stream = stderr, double every_s = 5);
  ~Progress();  // ends the line

  void stage(const std::string& what);  // "loading skull.inv3"
  void fraction(double done);           // 0 ... 1 of the stage
  void done();                          // clears the line: what follows is a result

 private:
  void show(const std::string& text);

  std::FILE* stream_;
  bool terminal_;
  double every_s_;
  Stopwatch since_;  // the stage's begin or its last fraction
  std::string stage_;
  std::string shown_;
};

}  // namespace palpate
