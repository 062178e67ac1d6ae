// SPDX-License-Identifier: Apache-2.0
#include "apps/console/progress.hpp"

#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "apps/console/message.hpp"
#include "base/outside_text.hpp"

namespace palpate {

Progress::Progress(std::FILE* stream, double every_s)
    : stream_(messagesAreJson() ? nullptr : stream),
      terminal_(stream_ != nullptr && isatty(fileno(stream_)) == 1),
      every_s_(every_s) {}

Progress::~Progress() {
  done();
}

void Progress::show(const std::string& text) {
  if (text == shown_) return;
  writeMessage(stream_, "\r\033[K" + text);
  shown_ = text;
}

void Progress::stage(const std::string& what) {
  if (tell_) tell_(stage_ = oneLine(what), 0);
  if (stream_ == nullptr) return;
  stage_ = oneLine(what);
  since_ = Stopwatch();
  if (terminal_) {
    show(stage_ + " ...");
  } else {
    writeMessage(stream_, stage_ + " ...\n");
  }
}

void Progress::fraction(double done, std::optional<double> left_s) {
  if (tell_) tell_(stage_, done);
  if (stream_ == nullptr) return;
  const std::string left = left_s ? fmt::format(", {} left", roughTime(*left_s)) : "";
  if (terminal_) {
    show(fmt::format("{} ... {:3.0f} %{}", stage_, 100 * done, left));
  } else if (since_.seconds() >= every_s_) {
    writeMessage(stream_, fmt::format("{}: {:.0f} %{} ...\n", stage_, 100 * done, left));
    since_ = Stopwatch();
  }
}

void Progress::done() {
  if (terminal_ && !shown_.empty()) {
    writeMessage(stream_, "\r\033[K");
  }
  shown_.clear();
}

std::string roughTime(double seconds) {
  constexpr double kMinute_s = 60, kHour_s = 3600;
  if (seconds < 2 * kMinute_s) return fmt::format("some {:.0f} s", 10 * std::ceil(seconds / 10));
  if (seconds < 2 * kHour_s) return fmt::format("some {:.0f} min", std::ceil(seconds / kMinute_s));
  return fmt::format("some {:.0f} h", std::ceil(seconds / kHour_s));
}

std::function<void(const char* pass, double done)> passProgress(Progress& progress, std::function<void()> stop) {
  return [&progress, stop = std::move(stop), shown = std::string()](const char* pass, double done) mutable {
    if (std::exchange(shown, pass) != pass) progress.stage(std::string("computing on Vulkan: ") + pass);
    progress.fraction(done);
    stop();
  };
}

}  // namespace palpate
