// SPDX-License-Identifier: Apache-2.0
// apps/console/progress.hpp: shows on stderr what the program is doing. On a terminal this is one line that is
// rewritten; elsewhere a line for each stage, and one every few seconds of a long stage. One thread.
#pragma once

#include <cstdio>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "base/stopwatch.hpp"

namespace palpate {

class Progress {
 public:
  // `every_s`: interval between lines of a long stage where there is no terminal [s].
  // Without a stream nothing is shown, nor where messages are for programs (messagesAreJson()).
  explicit Progress(std::FILE* stream = stderr, double every_s = 5);
  // Calls `tell` for every stage and fraction instead, which may throw to cancel.
  using Tell = std::function<void(const std::string& stage, double done)>;
  explicit Progress(Tell tell) : Progress(nullptr) { tell_ = std::move(tell); }
  ~Progress();  // ends the line

  void stage(const std::string& what);  // "loading skull.inv3"
  // 0 ... 1 of the stage, and how long the work will still take, where that is known [s].
  void fraction(double done, std::optional<double> left_s = {});
  void done();  // clears the line, before a result

 private:
  void show(const std::string& text);

  std::FILE* stream_;
  Tell tell_;  // empty: nobody
  bool terminal_;
  double every_s_;
  Stopwatch since_;  // since the stage began or its last fraction was shown
  std::string stage_;
  std::string shown_;
};

// "some 40 s", "some 12 min", "some 3 h": a time that is known roughly only.
[[nodiscard]] std::string roughTime(double seconds);

// The `progress` argument of Engine's constructor: shows each of its passes as a stage. `stop` is called after every
// submission and throws to end the work (Ctrl-C).
[[nodiscard]] std::function<void(const char* pass, double done)> passProgress(Progress& progress,
                                                                              std::function<void()> stop);

}  // namespace palpate
