// SPDX-License-Identifier: Apache-2.0
#include "apps/console/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include "apps/console/one_line.hpp"

namespace palpate {

Progress::Progress(std::FILE* stream, double every_s)
    : stream_(stream), terminal_(isatty(fileno(stream)) == 1), every_s_(every_s) {}

Progress::~Progress() {
  done();
}

void Progress::show(const std::string& text) {
  if (text == shown_) return;
  fmt::print(stream_, "\r\033[K{}", text);
  std::fflush(stream_);
  shown_ = text;
}

void Progress::stage(const std::string& what) {
  stage_ = oneLine(what);
  since_ = Stopwatch();
  if (terminal_) {
    show(stage_ + " ...");
  } else {
    fmt::print(stream_, "{} ...\n", stage_);
  }
}

void Progress::fraction(double done) {
  if (terminal_) {
    show(fmt::format("{} ... {:3.0f} %", stage_, 100 * done));
  } else if (since_.seconds() >= every_s_) {
    fmt::print(stream_, "{}: {:.0f} % ...\n", stage_, 100 * done);
    std::fflush(stream_);
    since_ = Stopwatch();
  }
}

void Progress::done() {
  if (terminal_ && !shown_.empty()) {
    fmt::print(stream_, "\r\033[K");
    std::fflush(stream_);
  }
  shown_.clear();
}

}  // namespace palpate
