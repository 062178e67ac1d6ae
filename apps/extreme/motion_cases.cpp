// SPDX-License-Identifier: Apache-2.0
// Where the tool may be and how it may move.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "apps/bench/random.hpp"
#include "apps/extreme/ground.hpp"

namespace palpate {
namespace motion_cases {
namespace {

Ground largeGround() {
  return {.size = Vec3i::Constant(64)};
}

ExtremeOutcome outside(const Vec3& p_W) {
  const Ground ground;
  RoughRun run = pressOn(ground.sampled(), ground);
  run.path_W = [=](double) { return p_W; };
  return Judge(run, play(run)).feelsNothing().raisesNoFadingFault().outcome();
}

// A tool that starts inside feels nothing until it has been outside once; then it feels the plane.
ExtremeOutcome insideAtStart(bool leaves) {
  const Ground ground;
  RoughRun run = pressOn(ground.sampled(), ground);
  const auto down_W = run.path_W;
  const auto up_W = [=](double time_s) { return down_W(0.3 - time_s); };
  run.seconds = 1;
  run.path_W = [=](double time_s) -> Vec3 {
    if (!leaves) return down_W(0.3);
    return time_s < 0.35 ? up_W(time_s) : down_W(time_s - 0.35);
  };
  Judge judge(run, play(run));
  judge.raises(ServoFault::kInsideObject);
  if (leaves) return judge.feels(ground.plane, placeError_m(ground)).outcome();
  return judge.feelsNothing().outcome();
}

// From free space to a place, within one tick.
ExtremeOutcome teleports(const Vec3& to_W, bool is_felt) {
  const Ground ground = largeGround();
  RoughRun run = pressOn(ground.sampled(), ground, -to_W.z() / 1e-3);
  const Vec3 start_W = run.path_W(0);
  run.path_W = [=](double time_s) { return time_s < 0.1 ? start_W : to_W; };
  Judge judge(run, play(run));
  if (is_felt) judge.feels(ground.plane, placeError_m(ground, -to_W.z() / 1e-3)).raisesNoFadingFault();
  return judge.outcome();
}

ExtremeOutcome returnsFromAfar(double away_m) {
  const Ground ground;
  RoughRun run = pressOn(ground.sampled(), ground);
  const auto press_W = run.path_W;
  run.path_W = [=](double time_s) -> Vec3 {
    return time_s < 0.1 || time_s > 0.15 ? press_W(std::max(0.0, time_s - 0.15)) : Vec3(away_m, away_m, away_m);
  };
  run.seconds = 0.8;
  return Judge(run, play(run)).feels(ground.plane, placeError_m(ground)).outcome();
}

ExtremeOutcome pressesAt(double speed_m_per_s, double depth_voxel) {
  const Ground ground = largeGround();
  RoughRun run = pressOn(ground.sampled(), ground, depth_voxel);
  const double from_m = 10e-3, to_m = -depth_voxel * 1e-3;
  run.path_W = [=](double time_s) { return Vec3(0, 0, std::max(to_m, from_m - speed_m_per_s * time_s)); };
  return Judge(run, play(run)).feels(ground.plane, placeError_m(ground, depth_voxel)).raisesNoFadingFault().outcome();
}

// Back and forth along the plane by 10 mm, 1.5 voxels deep, until the hand rests. `every_tick`: the plane must
// be felt all the time; a window that lies where the tool was a tick ago reaches 10 voxels further than the tool.
ExtremeOutcome slidesAt(double speed_m_per_s, bool every_tick) {
  const Ground ground = largeGround();
  RoughRun run = pressOn(ground.sampled(), ground);
  const auto press_W = run.path_W;
  constexpr double kReach_m = 10e-3, kFrom_s = 0.3, kUntil_s = 0.8;
  run.path_W = [=](double time_s) -> Vec3 {
    const double way_m = speed_m_per_s * (std::clamp(time_s, kFrom_s, kUntil_s) - kFrom_s);
    return press_W(time_s) + std::abs(std::remainder(way_m, 2 * kReach_m)) * Vec3::UnitX();
  };
  run.seconds = 1;
  Judge judge(run, play(run));
  if (every_tick) judge.raisesNoFadingFault();
  return judge.feels(ground.plane, placeError_m(ground)).outcome();
}

ExtremeOutcome restsForAnHour() {
  const Ground ground;
  RoughRun run = pressOn(ground.sampled(), ground);
  run.seconds = 3600;
  run.loop.record_ticks = 1000;
  run.parameters.damping_Ns_per_m = 0.5;
  Judge judge(run, play(run));
  judge.that(!judge.result().records.empty() && judge.result().records.back().tick == 3'600'000 - 1,
             "the last tick is not that of the hour's end");
  return judge.feels(ground.plane, placeError_m(ground)).raisesNoFadingFault().outcome();
}

// A hand that trembles by `reach_m` around the surface in every tick.
ExtremeOutcome trembles(double reach_m) {
  const Ground ground;
  RoughRun run = pressOn(ground.sampled(), ground);
  run.path_W = [=](double time_s) {
    Random random(static_cast<std::uint64_t>(std::llround(time_s * 1e6)));
    return Vec3(reach_m * random.direction());
  };
  return Judge(run, play(run)).outcome();
}

}  // namespace
}  // namespace motion_cases

void addMotionCases(ExtremeCases& to) {
  using namespace motion_cases;
  const auto add = [&](const char* name, const char* expectation, std::function<ExtremeOutcome()> run) {
    to.push_back({"motion", name, expectation, std::move(run)});
  };
  const char* nothing = "nothing is felt";
  const char* felt = "the plane is felt once the hand rests";
  const char* every = "the plane is felt in every tick";
  add("the tool rests outside the volume", nothing, [] { return outside(Vec3(0.1, 0.1, 0.1)); });
  add("the tool rests 1e9 m away", nothing, [] { return outside(Vec3(1e9, -1e9, 1e9)); });
  add("the tool starts inside and stays", "nothing is felt, and the run says why", [] { return insideAtStart(false); });
  add("the tool starts inside and leaves", "nothing is felt until it has been outside, then the plane",
      [] { return insideAtStart(true); });
  add("a jump of the tool by 5 mm into the object", felt, [] { return teleports(Vec3(0, 0, -1.5e-3), true); });
  add("a jump of the tool by 20 voxels into the object", "no force beyond the limits",
      [] { return teleports(Vec3(5e-3, -5e-3, -20e-3), false); });
  add("a jump of the tool by 1e6 m", "no force beyond the limits", [] { return teleports(Vec3(0, 0, -1e6), false); });
  add("a jump of the tool by 1 m and back", felt, [] { return returnsFromAfar(1); });
  add("a jump of the tool by 1e12 m and back", felt, [] { return returnsFromAfar(1e12); });
  add("met at 1 m/s", felt, [] { return pressesAt(1, 1.5); });
  add("met at 10 m/s", felt, [] { return pressesAt(10, 1.5); });
  add("met at 10 m/s, pressed 10 voxels", felt, [] { return pressesAt(10, 10); });
  add("pressed 25 voxels, beyond the middle of the window", felt, [] { return pressesAt(0.2, 25); });
  add("slid at 1 m/s", every, [] { return slidesAt(1, true); });
  add("slid at 5 m/s", every, [] { return slidesAt(5, true); });
  add("slid at 10 m/s", "the plane is felt again when the hand rests; meanwhile the window may be left behind",
      [] { return slidesAt(10, false); });
  add("still for an hour", "the same force after 3.6 million ticks", [] { return restsForAnHour(); });
  add("trembling by 0.1 mm around the surface", "no force beyond the limits", [] { return trembles(0.1e-3); });
  add("trembling by 5 mm around the surface", "no force beyond the limits", [] { return trembles(5e-3); });
}

}  // namespace palpate
