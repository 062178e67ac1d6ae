// SPDX-License-Identifier: Apache-2.0
#include "apps/doctor/trial.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <thread>

#include "apps/console/interrupt.hpp"
#include "base/monotonic_clock.hpp"
#include "base/quantile.hpp"
#include "base/thread_names.hpp"
#include "base/units.hpp"
#include "servo/loop/real_time.hpp"

namespace palpate {
namespace {

constexpr int kServoPriority = 80;

// What the trial's thread notes; memory for all ticks is there before the first.
struct Notes {
  std::vector<double> late_us;
  std::int64_t failed = 0, skipped = 0;
  Vec3 low = Vec3::Constant(INFINITY), high = Vec3::Constant(-INFINITY);
  RealTimeStatus real_time;
};

void tickAlong(Device* device, double rate_hz, std::int64_t ticks, const std::atomic<bool>& stop, Notes& notes) {
  nameThisThread("servo");
  notes.real_time = becomeRealTime(kServoPriority);
  const double period_ns = kNanosecondsPerSecond / rate_hz;
  const std::int64_t start_ns = monotonicNow_ns() + std::llround(period_ns);
  for (std::int64_t tick = 0; tick < ticks && !stop; ++tick) {
    const std::int64_t due_ns = start_ns + std::llround(static_cast<double>(tick) * period_ns);
    const auto behind_ns = static_cast<double>(monotonicNow_ns() - due_ns);
    if (behind_ns > period_ns) {
      ++notes.skipped;
      continue;
    }
    sleepUntil(due_ns);
    notes.late_us.push_back(static_cast<double>(monotonicNow_ns() - due_ns) / kNanosecondsPerMicrosecond);
    if (device == nullptr) continue;
    device->elapse(1);
    Vec3 position;
    if (device->read(position)) {
      notes.low = notes.low.cwiseMin(position);
      notes.high = notes.high.cwiseMax(position);
    } else {
      ++notes.failed;
    }
    static_cast<void>(device->write(Vec3::Zero()));
  }
}

double figureOf(const std::vector<DeviceFigure>& figures, std::string_view key) {
  const auto figure = std::ranges::find(figures, key, &DeviceFigure::key);
  return figure == figures.end() ? 0 : figure->value;
}

}  // namespace

TrialFigures tryServo(Device* device, double rate_hz, double seconds,
                      const std::function<void(double share)>& progress) {
  const std::int64_t ticks = std::llround(rate_hz * seconds);
  Notes notes;
  notes.late_us.reserve(static_cast<std::size_t>(ticks));
  const double received_before = device != nullptr ? figureOf(device->figures(), "reports_received") : 0;
  std::atomic<bool> stop{false}, done{false};
  const std::int64_t begin_ns = monotonicNow_ns();
  std::jthread servo([&] {
    tickAlong(device, rate_hz, ticks, stop, notes);
    done = true;
  });
  const auto passed_s = [&] { return static_cast<double>(monotonicNow_ns() - begin_ns) / kNanosecondsPerSecond; };
  while (!done) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    if (interrupted()) stop = true;
    try {
      progress(std::min(1.0, passed_s() / seconds));
    } catch (...) {
      stop = true;
      throw;
    }
  }
  servo.join();
  throwIfInterrupted("palpate doctor");
  TrialFigures trial{.rate_hz = rate_hz, .seconds = passed_s()};
  trial.fifo = notes.real_time.fifo;
  trial.memory_locked = notes.real_time.memory_locked;
  const Percentiles late = percentiles(std::move(notes.late_us));
  trial.late_p50_us = late.p50;
  trial.late_p99_us = late.p99;
  trial.late_max_us = late.max;
  trial.skipped_share = static_cast<double>(notes.skipped) / static_cast<double>(std::max<std::int64_t>(1, ticks));
  if (device == nullptr) return trial;
  trial.figures = device->figures();
  trial.force_off = device->forceOff();
  trial.reports_per_s = (figureOf(trial.figures, "reports_received") - received_before) / trial.seconds;
  trial.failed_share = static_cast<double>(notes.failed) / static_cast<double>(std::max<std::int64_t>(1, ticks));
  if ((notes.high - notes.low).allFinite()) trial.motion_m = (notes.high - notes.low).maxCoeff();
  return trial;
}

}  // namespace palpate
