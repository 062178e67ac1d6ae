// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/report_link.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "base/monotonic_clock.hpp"
#include "base/thread_names.hpp"
#include "base/units.hpp"
#include "servo/devices/one_writer.hpp"

namespace palpate {
namespace {

constexpr int kQuietRead_ms = 100;  // of a device that does not answer: how long a stop may have to wait [ms]
constexpr int kLate_ms = 2;         // how much later than an answer that was late its next one comes
constexpr double kSlept_ns = 1e8;   // the machine slept, if its clocks differ by more than before
constexpr int kMostQueued = 64;     // reports that Linux keeps for a reader

std::chrono::nanoseconds seconds(double s) {
  return std::chrono::nanoseconds(std::llround(s * kNanosecondsPerSecond));
}

class Deadline {
 public:
  explicit Deadline(int from_now_ms)
      : end_ns_(static_cast<double>(monotonicNow_ns()) + from_now_ms * kNanosecondsPerMillisecond) {}
  [[nodiscard]] int left_ms() const {  // rounded up
    const double left_ns = end_ns_ - static_cast<double>(monotonicNow_ns());
    return std::max(0, static_cast<int>(std::ceil(left_ns / kNanosecondsPerMillisecond)));
  }

 private:
  double end_ns_;
};

}  // namespace

ReportLink::ReportLink(PortOpener open, LinkSettings settings)
    : open_(std::move(open)), settings_(std::move(settings)), port_(open_()) {
  last_.connection = 1;
  slept_ns_ = suspended_ns();
  connected_.store(true, std::memory_order_release);
}

ReportLink::~ReportLink() {
  thread_ = {};  // asks it to stop and waits
  if (port_ && settings_.answers) static_cast<void>(port_->write(settings_.rest));
}

void ReportLink::start() {
  threaded_ = true;
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

void ReportLink::run(const std::stop_token& stop) {
  nameThisThread("device");
  if (settings_.thread_begins) settings_.thread_begins();
  while (!stop.stop_requested()) {
    if (port_ || reopen()) {
      static_cast<void>(exchange());
    } else {
      for (double waited_s = 0; waited_s < settings_.reopen_s && !stop.stop_requested(); waited_s += 0.01)
        std::this_thread::sleep_for(seconds(std::min(0.01, settings_.reopen_s)));
    }
  }
}

bool ReportLink::reopen() noexcept {
  try {
    port_ = open_();
  } catch (...) {  // it is not there yet; why is for whoever opens it first
    return false;
  }
  ++last_.connection;
  connection_.store(last_.connection, std::memory_order_release);
  // Most devices say something at once when they are switched on.
  waits_ = true;
  asked_ns_ = monotonicNow_ns();
  countUp(reconnects_);
  connected_.store(true, std::memory_order_release);
  return true;
}

// What the servo wanted of the device before it went away is nothing to begin with when it is back.
void ReportLink::lose() noexcept {
  lost_at_ns_ = monotonicNow_ns();
  waits_ = false;
  silence_ns_ = 0;
  answers_to_request_ = 0;
  asked_.store(false, std::memory_order_release);
  connected_.store(false, std::memory_order_release);
  port_.reset();
  countUp(disconnects_);
}

void ReportLink::post(const Report& command, std::int64_t now_ns) noexcept {
  commands_.back() = {command, now_ns, true};
  commands_.publish();
}

void ReportLink::askOnce(const Report& request) noexcept {
  requests_.back() = request;
  requests_.publish();
  asked_.store(true, std::memory_order_release);
}

const Report& ReportLink::outgoing(bool& is_request) noexcept {
  if (asked_.exchange(false, std::memory_order_acq_rel)) {
    is_request = true;
    return requests_.latest();
  }
  const Command& command = commands_.latest();
  const double age_ns = static_cast<double>(monotonicNow_ns() - command.time_ns);
  const bool fresh = age_ns <= settings_.command_life_s * kNanosecondsPerSecond || !threaded_;
  const bool meant = command.given && command.time_ns > lost_at_ns_;
  if (meant && fresh) return command.report;
  if (meant) countUp(rests_);
  return settings_.rest;
}

bool ReportLink::writeNext() noexcept {
  bool is_request = false;
  const Report& report = outgoing(is_request);
  const std::int64_t begin_ns = monotonicNow_ns();
  const bool taken = port_->write(report);
  writes_.add(monotonicNow_ns() - begin_ns);
  countUp(taken ? written_ : refused_);
  // The next report may be one that was on its way already.
  if (taken && is_request) answers_to_request_ = 2;
  return taken;
}

// Some systems' reads come back early with nothing, so the time is taken here.
PortRead ReportLink::readWithin(Report& report, int most_ms) noexcept {
  const Deadline deadline(most_ms);
  while (true) {
    const int left_ms = deadline.left_ms();
    const PortRead got = port_->read(report, left_ms);
    if (got != PortRead::kNothing || left_ms == 0) return got;
    if (deadline.left_ms() > 1) std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
}

// Before what is known changes: what should have come meanwhile.
void ReportLink::countGap() noexcept {
  if (!settings_.moves || !(settings_.interval_s > 0) || last_.number == 0 || !settings_.moves(last_.report)) return;
  const double gap_ns = static_cast<double>(monotonicNow_ns() - last_.time_ns);
  const double intervals = gap_ns / (settings_.interval_s * kNanosecondsPerSecond);
  countUp(lost_, static_cast<std::uint64_t>(std::max(0.0, std::round(intervals) - 1)));
}

bool ReportLink::fold(const Report& report) noexcept {
  if (settings_.fold) return settings_.fold(last_.report, report);
  last_.report = report;
  return true;
}

// Not more than the device was waited for: that this thread was held up is no silence of the device.
void ReportLink::beSilent(std::int64_t since_ns) noexcept {
  const auto most_ns = std::llround(settings_.answer_ms * kNanosecondsPerMillisecond);
  const std::int64_t silent_ns = std::min<std::int64_t>(monotonicNow_ns() - since_ns, most_ns);
  silence_ns_ += silent_ns;
  last_.silent_ns += silent_ns;
}

bool ReportLink::mayHaveForgotten() noexcept {
  const std::int64_t slept_ns = suspended_ns();
  const bool slept = std::abs(static_cast<double>(slept_ns - slept_ns_)) > kSlept_ns;
  slept_ns_ = slept_ns;
  const auto silence_ns = static_cast<double>(std::exchange(silence_ns_, 0));
  return threaded_ && settings_.answers && (slept || silence_ns >= settings_.forgets_s * kNanosecondsPerSecond);
}

void ReportLink::tell() noexcept {
  if (mayHaveForgotten()) {
    ++last_.connection;
    connection_.store(last_.connection, std::memory_order_release);
  }
  if (answers_to_request_ > 0 && --answers_to_request_ == 0) ++last_.requests;
  last_.time_ns = monotonicNow_ns();
  last_.asked_ns = waits_ ? asked_ns_ : last_.time_ns;
  waits_ = false;
  ++last_.number;
  countUp(taken_);
  received_.back() = last_;
  received_.publish();
}

bool ReportLink::listen(int most_ms) noexcept {
  Report report;
  if (!std::exchange(waits_, true)) asked_ns_ = monotonicNow_ns();
  if (!port_ || readWithin(report, most_ms) != PortRead::kReport) return false;
  last_.unasked = true;
  if (fold(report)) tell();
  last_.unasked = false;
  return true;
}

bool ReportLink::exchange() noexcept {
  if (!port_ && !reopen()) return false;
  const std::int64_t begin_ns = monotonicNow_ns();
  const bool is_owed = std::exchange(waits_, true);  // an answer that did not come in time, and may come now
  if (!is_owed) asked_ns_ = begin_ns;
  if (settings_.answers && !writeNext()) {
    lose();
    return false;
  }
  Report report;
  const PortRead got = readWithin(report, settings_.answers ? settings_.answer_ms : kQuietRead_ms);
  if (got == PortRead::kGone) {
    lose();
    return false;
  }
  if (got == PortRead::kNothing) {
    if (settings_.answers) countUp(lost_);
    beSilent(begin_ns);
    return false;
  }
  countGap();
  bool told = fold(report);
  int wait_ms = is_owed && settings_.answers ? std::min(settings_.answer_ms, kLate_ms) : 0;
  for (int more = 0; more < kMostQueued && readWithin(report, wait_ms) == PortRead::kReport; ++more) {
    countUp(superseded_);
    told = fold(report) || told;
    wait_ms = 0;
  }
  told ? tell() : beSilent(begin_ns);
  return told;
}

LinkFigures ReportLink::figures() const noexcept {
  const auto value = [](const Counter& counter) { return counter.load(std::memory_order_relaxed); };
  return {.written = value(written_),
          .received = value(taken_),
          .lost = value(lost_),
          .superseded = value(superseded_),
          .refused = value(refused_),
          .rests = value(rests_),
          .disconnects = value(disconnects_),
          .reconnects = value(reconnects_),
          .write_p50_us = writes_.quantile_ns(0.5) / kNanosecondsPerMicrosecond,
          .write_p99_us = writes_.quantile_ns(0.99) / kNanosecondsPerMicrosecond,
          .write_max_us = static_cast<double>(writes_.longest_ns()) / kNanosecondsPerMicrosecond};
}

}  // namespace palpate
