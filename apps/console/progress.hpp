// SPDX-License-Identifier: Apache-2.0
// apps/console/progress.hpp: tells a waiting person what is going on, on stderr: one line that is rewritten on a
// terminal, a line a stage elsewhere. One thread.
#pragma once

#include <cstdio>
#include <string>

namespace palpate {

class Progress {
 public:
  explicit Progress(std::FILE* stream = stderr);
  ~Progress();  // ends the line

  void stage(const std::string& what);  // "loading skull.inv3"
  void fraction(double done);           // 0 ... 1 of the stage; shown on a terminal only
  void done();                          // clears the line: what follows is a result

 private:
  void show(const std::string& text);

  std::FILE* stream_;
  bool terminal_;
  std::string stage_;
  std::string shown_;
};

}  // namespace palpate
