// SPDX-License-Identifier: Apache-2.0
// Windows that come late, once, never, again and again, or with nonsense in them.
#include <limits>

#include "apps/extreme/ground.hpp"

namespace palpate {
namespace window_cases {
namespace {

Ground largeGround() {
  return {.size = Vec3i::Constant(64)};
}

RoughRun with(const Ground& ground, WindowManner manner) {
  RoughRun run = pressOn(ground.sampled(), ground);
  run.windows = std::move(manner);
  run.seconds = 1.5;
  return run;
}

ExtremeOutcome feelsWith(WindowManner manner) {
  const Ground ground = largeGround();
  const RoughRun run = with(ground, std::move(manner));
  return Judge(run, play(run)).feels(ground.plane, placeError_m(ground)).outcome();
}

// Slides at 0.3 m/s, 1 voxel deep, with windows that lie behind the tool.
ExtremeOutcome slidesWithLate(int late_ticks, bool is_felt) {
  const Ground ground = largeGround();
  RoughRun run = with(ground, {.late_ticks = late_ticks});
  const auto press_W = run.path_W;
  run.path_W = [=](double time_s) -> Vec3 {
    const double way_m = 0.3 * std::clamp(time_s - 0.3, 0.0, 0.06);
    return press_W(time_s) + Vec3(way_m, 0, 0);
  };
  run.seconds = 1;
  Judge judge(run, play(run));
  if (is_felt) judge.raisesNoFadingFault();
  return judge.feels(ground.plane, placeError_m(ground)).outcome();
}

ExtremeOutcome spoiled(std::function<void(SampleWindow&, Sample*)> spoil) {
  const Ground ground;
  const RoughRun run = with(ground, {.spoil = std::move(spoil)});
  return Judge(run, play(run)).outcome();
}

std::function<void(SampleWindow&, Sample*)> everySample(float density, float gradient) {
  return [=](SampleWindow& window, Sample* samples) {
    const auto count = static_cast<std::size_t>(window.size.prod());
    for (std::size_t i = 0; i < count; i += 3) samples[i] = {gradient, gradient, gradient, density};
  };
}

}  // namespace
}  // namespace window_cases

void addWindowCases(ExtremeCases& to) {
  using namespace window_cases;
  const auto add = [&](const char* name, const char* expectation, std::function<ExtremeOutcome()> run) {
    to.push_back({"windows", name, expectation, std::move(run)});
  };
  const char* safe = "no force beyond the limits, no VHIP that is not finite";
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();
  add("none ever comes", "nothing is felt, and it is told", [] {
    const Ground ground;
    RoughRun run = pressOn(nullptr, ground);
    return Judge(run, play(run)).feelsNothing().raises(ServoFault::kNoWindow).outcome();
  });
  add("the first comes in contact, after 0.35 s", "nothing is felt: the tool was never seen outside", [] {
    const Ground ground;
    RoughRun run = pressOn(ground.sampled(), ground);
    run.windows.first_tick = 350;
    return Judge(run, play(run)).feelsNothing().outcome();
  });
  add("the first comes in free space, after 0.1 s", "the plane is felt", [] { return feelsWith({.first_tick = 100}); });
  add("none comes after 0.35 s, in contact", "told, and no force is left", [] {
    const Ground ground;
    RoughRun run = with(ground, {.last_tick = 350});
    return Judge(run, play(run)).raises(ServoFault::kStaleWindow).endsWithoutForce().outcome();
  });
  add("the same one in every tick", "the plane is felt", [] { return feelsWith({.every_tick = true}); });
  add("the whole volume as one", "the plane is felt", [] { return feelsWith({.whole = true}); });
  add("late by 10 ms, slid at 0.3 m/s", "the plane is felt in every tick", [] { return slidesWithLate(10, true); });
  add("late by 100 ms, slid at 0.3 m/s", "the plane is felt once they have come",
      [] { return slidesWithLate(100, false); });
  add("samples that are no numbers", safe, [] { return spoiled(everySample(kNan, kNan)); });
  add("gradients that are no numbers", safe, [] {
    return spoiled([](SampleWindow& window, Sample* samples) {
      const auto count = static_cast<std::size_t>(window.size.prod());
      for (std::size_t i = 0; i < count; ++i) samples[i].gradient_i = kNan;
    });
  });
  add("infinite samples", safe, [] { return spoiled(everySample(kInfinity, kInfinity)); });
  add("samples of 3e38", safe, [] { return spoiled(everySample(3e38F, -3e38F)); });
  add("gradients that are all zero", "told, and nothing wild is felt", [] {
    const Ground ground;
    RoughRun run = with(ground, {.spoil = [](SampleWindow& window, Sample* samples) {
                          const auto count = static_cast<std::size_t>(window.size.prod());
                          for (std::size_t i = 0; i < count; ++i) samples[i] = {0, 0, 0, samples[i].density};
                        }});
    return Judge(run, play(run)).raises(ServoFault::kZeroGradient).outcome();
  });
  add("gradients that point the wrong way", safe, [] {
    return spoiled([](SampleWindow& window, Sample* samples) {
      const auto count = static_cast<std::size_t>(window.size.prod());
      for (std::size_t i = 0; i < count; ++i) samples[i].gradient_k *= -1;
    });
  });
  add("stamps from the future", safe,
      [] { return spoiled([](SampleWindow& window, Sample*) { window.stamp_ns += 1'000'000'000'000; }); });
  add("stamps from long ago", safe, [] {
    return spoiled(
        [](SampleWindow& window, Sample*) { window.stamp_ns = std::numeric_limits<std::int64_t>::min() / 2; });
  });
}

}  // namespace palpate
