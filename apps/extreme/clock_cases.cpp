// SPDX-License-Identifier: Apache-2.0
// Ticks that come late, early, in bursts, or not at all.
#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "apps/bench/random.hpp"
#include "apps/extreme/ground.hpp"

namespace palpate {
namespace clock_cases {
namespace {

using Wake = std::function<std::int64_t(std::int64_t due_ns)>;
constexpr std::int64_t kMillisecond = 1'000'000;

RoughRun withClock(const Ground& ground, const Wake& wake) {
  RoughRun run = pressOn(ground.sampled(), ground);
  run.wake_ns = wake;
  return run;
}

ExtremeOutcome feelsWith(const Wake& wake) {
  const Ground ground;
  const RoughRun run = withClock(ground, wake);
  return Judge(run, play(run)).feels(ground.plane, placeError_m(ground)).outcome();
}

ExtremeOutcome tells(ServoFault fault, const Wake& wake) {
  const Ground ground;
  RoughRun run = withClock(ground, wake);
  run.seconds = 0.8;
  return Judge(run, play(run)).raises(fault).feels(ground.plane, placeError_m(ground)).outcome();
}

// Late by up to `most_ns` in every tick, the same in every run.
Wake jitter(std::int64_t most_ns) {
  auto random = std::make_shared<Random>(3);
  return [=](std::int64_t due_ns) {
    if (due_ns <= kMillisecond) *random = Random(3);  // the run begins
    return due_ns + static_cast<std::int64_t>(random->uniform() * static_cast<double>(most_ns));
  };
}

// One sleep that ends `late_ns` after its time, when 0.2 s have passed.
Wake stallOnce(std::int64_t late_ns) {
  return [=](std::int64_t due_ns) {
    constexpr std::int64_t kWhen = 200 * kMillisecond;
    return due_ns >= kWhen && due_ns < kWhen + kMillisecond ? due_ns + late_ns : due_ns;
  };
}

ExtremeOutcome feelsAtRate(double rate_hz, double seconds) {
  const Ground ground;
  RoughRun run = pressOn(ground.sampled(), ground);
  run.loop.rate_hz = rate_hz;
  run.loop.safety.stale_window_s = std::max(run.loop.safety.stale_window_s, 2 / rate_hz);
  run.loop.safety.stall_s = std::max(run.loop.safety.stall_s, 2 / rate_hz);
  run.loop.safety.report_timeout_s = std::max(run.loop.safety.report_timeout_s, 2 / rate_hz);
  run.seconds = seconds;
  return Judge(run, play(run)).feels(ground.plane, placeError_m(ground)).raisesNoFadingFault().outcome();
}

}  // namespace
}  // namespace clock_cases

void addClockCases(ExtremeCases& to) {
  using namespace clock_cases;
  const auto add = [&](const char* name, const char* expectation, std::function<ExtremeOutcome()> run) {
    to.push_back({"clock", name, expectation, std::move(run)});
  };
  const char* felt = "the plane is felt";
  const char* told = "the fault is told, the force starts from zero and comes back";
  add("ticks late by up to 0.9 ms", felt, [] { return feelsWith(jitter(9 * kMillisecond / 10)); });
  add("ticks late by up to 5 ms", felt, [] { return feelsWith(jitter(5 * kMillisecond)); });
  add("a stall of 50 ms in contact", told, [] { return tells(ServoFault::kStall, stallOnce(50 * kMillisecond)); });
  add("a stall of 300 ms in contact", told, [] { return tells(ServoFault::kStall, stallOnce(300 * kMillisecond)); });
  add("a clock that steps back by 1 s", "no force beyond the limits", [] {
    const Ground ground;
    RoughRun run = withClock(ground, stallOnce(-1000 * kMillisecond));
    return Judge(run, play(run)).outcome();
  });
  add("1 tick a second", felt, [] { return feelsAtRate(1, 60); });
  add("20000 ticks a second", felt, [] { return feelsAtRate(20000, 0.5); });
}

}  // namespace palpate
