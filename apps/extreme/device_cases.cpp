// SPDX-License-Identifier: Apache-2.0
// Devices that lie, fail, saturate or weigh nothing.
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "apps/extreme/ground.hpp"

namespace palpate {
namespace device_cases {
namespace {

constexpr std::int64_t kInContact = 350;  // the hand rests in contact since tick 300
constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();

RoughRun usual(const Ground& ground) {
  RoughRun run = pressOn(ground.sampled(), ground);
  run.seconds = 1;
  run.parameters.damping_Ns_per_m = 0.5;
  return run;
}

// One reading in contact is another one.
ExtremeOutcome readsOnce(const Vec3& wild_W, bool is_told) {
  const Ground ground;
  RoughRun run = usual(ground);
  run.on_read = [=](std::int64_t call, Vec3& position_W) {
    if (call == kInContact) position_W = wild_W;
    return true;
  };
  Judge judge(run, play(run));
  if (is_told) judge.raises(ServoFault::kDeviceError);
  return judge.feels(ground.plane, placeError_m(ground)).outcome();
}

// As after a new calibration.
ExtremeOutcome movesAway() {
  const Ground ground;
  RoughRun run = usual(ground);
  run.on_read = [=](std::int64_t call, Vec3& position_W) {
    if (call >= kInContact) position_W += Vec3(0, 100, 0);
    return true;
  };
  Judge judge(run, play(run));
  const double off_m = std::abs(asVec3(judge.result().records.back().hip_W).y() - 100);
  judge.that(off_m < 1e-9, fmt::format("the tool ends {:g} m from where the device says", off_m));
  return judge.raises(ServoFault::kDeviceError).endsWithoutForce().outcome();
}

ExtremeOutcome readsNothing(std::int64_t from, std::int64_t until, bool comes_back) {
  const Ground ground;
  RoughRun run = usual(ground);
  run.on_read = [=](std::int64_t call, Vec3&) { return call < from || call >= until; };
  Judge judge(run, play(run));
  judge.raises(ServoFault::kDeviceError);
  return comes_back ? judge.feels(ground.plane, placeError_m(ground)).outcome() : judge.endsWithoutForce().outcome();
}

ExtremeOutcome refusesForces(std::int64_t from, std::int64_t until) {
  const Ground ground;
  RoughRun run = usual(ground);
  run.on_write = [=](std::int64_t call) { return call < from || call >= until; };
  return Judge(run, play(run)).raises(ServoFault::kDeviceError).feels(ground.plane, placeError_m(ground)).outcome();
}

ExtremeOutcome saysThatItHolds(const Vec3& held_W) {
  const Ground ground;
  RoughRun run = usual(ground);
  run.on_held = [=](const Vec3&) { return held_W; };
  return Judge(run, play(run)).outcome();
}

// The plane asks for more than the device can give: it gives its limit, along the normal.
ExtremeOutcome saturates(double limit_N, double stiffness_N_per_m) {
  const Ground ground;
  RoughRun run = usual(ground);
  run.device.force_limit_N = limit_N;
  run.parameters.stiffness_N_per_m = stiffness_N_per_m;
  Judge judge(run, play(run));
  const double last_N = asVec3(judge.result().records.back().force_W).norm();
  judge.that(std::abs(last_N - limit_N) <= 1e-9 * limit_N, fmt::format("it gives {:g} N, not its limit", last_N));
  return judge.raises(ServoFault::kForceLimited).isPushed(Vec3::UnitZ(), 0.999 * limit_N).outcome();
}

ExtremeOutcome heldBy(const HandParameters& hand, double encoder_m, int delay_ticks) {
  const Ground ground;
  RoughRun run = usual(ground);
  run.device.hand = Hand::kSpring;
  run.device.dynamics = hand;
  run.device.encoder_resolution_m = encoder_m;
  run.device.delay_ticks = delay_ticks;
  run.parameters.stiffness_N_per_m = 500;
  return Judge(run, play(run)).outcome();
}

}  // namespace
}  // namespace device_cases

void addDeviceCases(ExtremeCases& to) {
  using namespace device_cases;
  const auto add = [&](const std::string& name, const char* expectation, std::function<ExtremeOutcome()> run) {
    to.push_back({"devices", name, expectation, std::move(run)});
  };
  const char* back = "told; the force fades, and the plane is felt again";
  const char* safe = "no force beyond the limits, no VHIP that is not finite";
  add("a position that is no number", back, [] { return readsOnce(Vec3(0, kNan, 0), true); });
  add("an infinite position", back, [] { return readsOnce(Vec3(kInfinity, 0, 0), true); });
  add("a position of 1e300 m", back, [] { return readsOnce(Vec3(1e300, -1e300, 1e300), true); });
  add("a position 100 m away, once", back, [] { return readsOnce(Vec3(100, 0, 0), true); });
  add("a position 2 m away, once", back, [] { return readsOnce(Vec3(-1, -1, 2), true); });
  add("positions 100 m away from one tick on", "told; then the tool is there, and nothing is felt",
      [] { return movesAway(); });
  add("a position 1 cm away, once", "no force beyond the limits, and the plane is felt again",
      [] { return readsOnce(Vec3(0, 0, 1e-2), false); });
  add("no answer for one tick", back, [] { return readsNothing(kInContact, kInContact + 1, true); });
  add("no answer for 200 ticks", back, [] { return readsNothing(kInContact, kInContact + 200, true); });
  add("no answer any more", "told, and no force is left", [] { return readsNothing(kInContact, 1 << 30, false); });
  add("forces refused for 100 ticks", back, [] { return refusesForces(kInContact, kInContact + 100); });
  add("it says that it holds NaN", safe, [] { return saysThatItHolds(Vec3::Constant(kNan)); });
  add("it says that it holds 1e9 N", safe, [] { return saysThatItHolds(Vec3(1e9, 0, 0)); });
  add("saturated at 0.1 N", "its limit along the normal, and it is told", [] { return saturates(0.1, 500); });
  add("saturated at 8 N by a wall of 1e9 N/m", "its limit along the normal, and it is told",
      [] { return saturates(8, 1e9); });
  add("a hand and a device without mass", "refused: nothing can be simulated without mass",
      [] { return refusedWith("mass", [] { (void)heldBy({.hand_mass_kg = 0, .device_mass_kg = 0}, 0, 0); }); });
  add("a mass of 1 mg", safe, [] { return heldBy({.hand_mass_kg = 0, .device_mass_kg = 1e-6}, 0, 0); });
  add("a mass of 1000 kg", safe, [] { return heldBy({.hand_mass_kg = 1000, .device_mass_kg = 0.05}, 0, 0); });
  add("encoder steps of 1 cm", safe, [] { return heldBy({}, 1e-2, 0); });
  add("a delay of 1000 ticks", safe, [] { return heldBy({}, 0, 1000); });
}

}  // namespace palpate
