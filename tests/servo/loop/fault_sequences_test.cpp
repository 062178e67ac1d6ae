// SPDX-License-Identifier: Apache-2.0
// Random faults, one over the other, under random settings, in the loop's own code on a scripted clock: no force leaves
// that is not finite, above the limit, or more than a slew from the one that the device took last; a fault that lasts
// takes the force to zero within the fade; and when all is well again the force is the one that the algorithm wants.
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <string_view>

#include <gtest/gtest.h>

#include "servo/algorithms/registry.hpp"
#include "servo/contact/effects.hpp"
#include "servo/meshes/mesh_object.hpp"
#include "servo/objects/shapes.hpp"
#include "support/fault_injection.hpp"
#include "support/isosurface_mesh.hpp"

namespace palpate {
namespace fault_sequences_test {

#if defined(__SANITIZE_THREAD__) || defined(__SANITIZE_ADDRESS__)
constexpr int kSequences = 500;
#else
constexpr int kSequences = 12000;
#endif

constexpr int kFaultyTicks = 80;  // all faults begin and end before
constexpr int kMostFadeTicks = 40;
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

// The pole of a ball of 5 mm, in one window that holds all but wild positions and reaches the border above.
const AnalyticVolume& volume() {
  static const AnalyticVolume kVolume = millimetreVolume(ball(Vec3::Constant(8e-3), 5e-3), 16);
  return kVolume;
}
Vec3 abovePole(double height_m, double aside_m) {
  return Vec3(8e-3 + aside_m, 8e-3, 13e-3 + height_m);
}

class Dice {
 public:
  explicit Dice(unsigned seed) : random_(seed) {}
  double between(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  double decades(double low, double high) { return std::pow(10, between(std::log10(low), std::log10(high))); }
  int whole(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }
  bool coin() { return whole(0, 1) == 1; }

 private:
  std::mt19937 random_;
};

InjectedFault randomFault(Dice& dice) {
  InjectedFault fault;
  fault.kind = static_cast<Injected>(dice.whole(0, static_cast<int>(Injected::kCount) - 1));
  fault.first_tick = dice.whole(0, kFaultyTicks - 2);
  fault.ticks = std::min(dice.coin() ? dice.whole(1, 3) : dice.whole(1, 70), kFaultyTicks - fault.first_tick);
  const double sign = dice.coin() ? 1 : -1;
  switch (fault.kind) {
    case Injected::kEngineClock:
      fault.size = sign * dice.decades(1e-3, 1e4);
      break;
    case Injected::kServoClock:
      fault.size = sign * dice.decades(1e-3, 1);
      break;
    case Injected::kStallAsleep:
    case Injected::kStallInTick:
      fault.size = dice.coin() ? 0.05 : dice.decades(1e-4, 0.3);
      break;
    case Injected::kWildPosition:
      // Half of them are so near that the servo believes them, at least at slow rates (MotionBounds).
      fault.size = sign * (dice.coin() ? dice.decades(1e-4, 10) : dice.coin() ? 1e308 : dice.decades(1e-4, 1e300));
      break;
    case Injected::kHugeForce:
      fault.size = sign * dice.decades(1, 1e308);
      break;
    default:
      break;
  }
  return fault;
}

LoopParameters randomParameters(Dice& dice) {
  LoopParameters p;
  p.rate_hz = dice.decades(100, 20000);
  p.safety.force_limit_N = dice.decades(0.1, 20);
  // Such that neither takes more than kMostFadeTicks.
  p.safety.fade_s = dice.whole(0, kMostFadeTicks) / p.rate_hz;
  p.safety.slew_limit_N_per_s = p.safety.force_limit_N * p.rate_hz * dice.decades(1.0 / (kMostFadeTicks - 1), 10);
  p.safety.stale_window_s = dice.decades(2, 30) / p.rate_hz;
  p.safety.stall_s = dice.decades(1e-3, 0.04);
  p.safety.report_timeout_s = dice.decades(2, 30) / p.rate_hz;
  p.velocity.name = dice.coin() ? "filter" : "foaw";
  p.passivity.control = dice.coin();
  p.passivity.forget_credit = dice.coin();
  p.ticks = 0;
  return p;
}

struct Seen {
  std::uint32_t faults = 0;
  int pushing_at_the_end = 0;
  int fades_to_zero = 0;
  int damped_ticks = 0;
  int refused_while_holding = 0;
  int cut_by_the_device = 0;
  int back_to_the_wanted = 0;
  std::set<std::string_view> algorithms;
  std::string_view algorithm;  // of the sequence that is played; empty: the steady push
};

// Judged by what the device holds: each offer, whether it is taken or not, is finite, within the limit, and at most one
// slew from what the device holds when it is made.
void checkEveryForce(const ScriptedDevice& device, const SafetyParameters& safety, double slew_per_tick_N) {
  // Cutting to the limit and moving by the slew are a division and a product each: some roundings of the force's size.
  const double rounding_N = 8 * kEpsilon * (safety.force_limit_N + slew_per_tick_N);
  Vec3 held_W = Vec3::Zero();
  for (std::size_t i = 0; i < device.written_W.size(); ++i) {
    const Vec3& offer_W = device.written_W[i];
    ASSERT_TRUE(offer_W.allFinite()) << i;
    ASSERT_LE(offer_W.norm(), safety.force_limit_N + rounding_N) << i;
    ASSERT_LE((offer_W - held_W).norm(), slew_per_tick_N + rounding_N) << i;
    held_W = device.held_W[i];
  }
  EXPECT_TRUE(held_W.isZero(0));
}

// While the gate sees a fault, each force that the device takes is smaller than the one that it held, and after as many
// of them as the fade has ticks it is zero. A write that is refused leaves the force as it was; it is noted in its
// tick, but the gate can only act on it in the next.
void checkFades(const std::vector<TickRecord>& records, const ScriptedDevice& device, std::int64_t fade_ticks,
                Seen& seen) {
  std::int64_t taken_in_fault = 0;
  double last_N = 0;
  for (std::size_t i = 0; i < records.size(); ++i) {
    const Vec3 force_W(records[i].force_W[0], records[i].force_W[1], records[i].force_W[2]);
    ASSERT_EQ(force_W, device.held_W[i]) << i;
    const double force_N = force_W.norm();
    std::uint32_t faults = records[i].faults;
    const bool late_news = !device.taken[i] && device.answered[i] && (i == 0 || device.taken[i - 1]);
    if (late_news) faults &= ~bit(ServoFault::kDeviceError);
    const bool faulty = (faults & kFadingFaults) != 0;
    taken_in_fault = faulty && device.taken[i] ? taken_in_fault + 1 : 0;
    if (taken_in_fault > 0) {
      ASSERT_TRUE(force_N == 0 || force_N < last_N) << i;
    }
    if (taken_in_fault >= fade_ticks) {
      ASSERT_EQ(force_N, 0) << i;
    }
    if (taken_in_fault > 0 && force_N == 0 && last_N > 0) ++seen.fades_to_zero;
    if (!device.taken[i] && force_N > 0) ++seen.refused_while_holding;
    last_N = force_N;
    seen.faults |= records[i].faults;
    seen.damped_ticks += records[i].damped ? 1 : 0;
  }
}

// The faults are over for longer than the longest fade: the force is the algorithm's, cut to the limit.
void checkEnd(const TickRecord& last, const Vec3& wanted_W, double limit_N, double cut_N, Seen& seen) {
  const std::uint32_t fading = last.faults & kFadingFaults;
  ASSERT_EQ(fading & ~bit(ServoFault::kSurfaceLost), 0u) << seen.algorithm << ' ' << faultNames(last.faults);
  if (fading != 0) {  // broken samples took its surface, and the tool has not been outside since
    ASSERT_TRUE(Vec3(last.force_W[0], last.force_W[1], last.force_W[2]).isZero(0));
    return;
  }
  const double wanted_N = wanted_W.stableNorm();  // after a wild position the velocity may still be huge
  const Vec3 expected_W = wanted_N > limit_N ? Vec3(wanted_W / wanted_N * limit_N) : wanted_W;
  const Vec3 force_W(last.force_W[0], last.force_W[1], last.force_W[2]);
  // An algorithm whose force trembles faster than the slew is never caught up with.
  // A device that cuts holds as much as it can; the gate may be on its way from there for ever.
  const bool cut = expected_W.norm() > cut_N;
  if (cut && !last.damped) {
    ASSERT_LE(force_W.norm(), cut_N * (1 + 8 * kEpsilon));
    ++seen.cut_by_the_device;
  }
  if (!cut && !last.damped && !has(last.faults, ServoFault::kSlewLimited)) {
    ASSERT_LE((force_W - expected_W).norm(), 8 * kEpsilon * limit_N) << seen.algorithm;
    ++seen.back_to_the_wanted;
  }
  if (force_W.norm() > 0) ++seen.pushing_at_the_end;
}

// The mesh of the ball, made once.
const std::shared_ptr<const ContactObject>& mesh() {
  static const std::shared_ptr<const ContactObject> kMesh =
      std::make_shared<const MeshObject>(IsosurfaceMesher(volume(), 0).mesh());
  return kMesh;
}

ContactEffects randomEffects(Dice& dice, double stiffness_N_per_m) {
  EffectParameters p;
  p.force_shading = dice.whole(0, 1) == 1;
  p.recovery_s = dice.whole(0, 1) * 0.01;
  p.texture = dice.whole(0, 1) == 1 ? TextureKind::kDensity : TextureKind::kProcedural;
  p.friction = {.static_ratio = 0.5, .dynamic_ratio = 0.3, .viscous_Ns_per_m = dice.between(0, 2)};
  p.stiffness_by_density = {{-1e-3, 0.5}, {2e-3, 2}};
  return makeContactEffects(p, stiffness_N_per_m, 1000);
}

// One of the registry, half of those that can with contact effects and an object beside the volume; or a push that does
// not ask where the tool is.
std::unique_ptr<Algorithm> randomAlgorithm(Dice& dice, Seen& seen) {
  const auto registry = algorithms();
  seen.algorithm = {};
  const auto which = static_cast<std::size_t>(dice.whole(0, static_cast<int>(registry.size())));
  AlgorithmSetup setup;
  setup.parameters.stiffness_N_per_m = dice.decades(50, 5000);
  if (which < registry.size()) {
    const std::string_view name = registry[which].name;
    const bool has_vhip = name != "avila" && name != "haptization";
    if (has_vhip && dice.whole(0, 1) == 1) {
      setup.effects = randomEffects(dice, setup.parameters.stiffness_N_per_m);
      setup.objects.push_back(std::make_shared<SphereObject>(abovePole(1e-3, 3e-3), 2e-3));
    }
    if (registry[which].needs.isosurface_mesh) setup.isosurface = mesh();
    seen.algorithms.insert(name);
    seen.algorithm = name;
    return makeAlgorithm(name, std::move(setup));
  }
  return std::make_unique<SteadyPush>(Vec3(dice.between(-9, 9), dice.between(-9, 9), dice.between(-9, 9)));
}

void playSequence(unsigned seed, WindowStorage& storage, Seen& seen) {
  Dice dice(seed);
  LoopParameters p = randomParameters(dice);
  FaultScript script;
  for (int i = dice.whole(1, 4); i > 0; --i) script.faults.push_back(randomFault(dice));
  // Refused writes go with every other fault.
  if (dice.coin()) {
    InjectedFault refusal = randomFault(dice);
    refusal.kind = dice.coin() ? Injected::kWriteError : Injected::kFlakyWrites;
    script.faults.push_back(refusal);
  }
  // After the faults: the gate's fade and slew, and the longest of the limits (30 ticks) until the last of them is
  // past.
  const int ticks = kFaultyTicks + 3 * kMostFadeTicks + 30;
  p.record_ticks = ticks;

  ScriptedClock clock(script);
  ScriptedEngine engine(script, volume(), abovePole(0, 0));
  const double depth_m = dice.decades(1e-4, 2e-3);
  // In within five ticks, then a small circle; still after the faults.
  const auto motion = [&](int tick) {
    const double angle = 0.05 * std::min(tick, kFaultyTicks);
    return Vec3(abovePole(-depth_m * std::min(1.0, (tick - 3) / 5.0), 1e-4 * std::sin(angle)));
  };
  ScriptedDevice device(script, clock, motion, p.rate_hz);
  if (dice.whole(0, 3) == 0) device.cut_N = p.safety.force_limit_N * dice.decades(0.1, 1);
  const std::unique_ptr<Algorithm> inner = randomAlgorithm(dice, seen);
  ScriptedAlgorithm algorithm(script, *inner);
  WindowExchange windows(storage);
  ToolPoseMailbox tool;
  ServoLoop loop(p, algorithm, device, windows, tool);
  const int first_window = dice.whole(0, 3);
  clock.before_tick = [&] {
    if (script.tick >= ticks) return;
    if (script.tick >= first_window) engine.beforeTick(windows, clock.time_ns);
    if (script.tick == ticks - 1) loop.requestStop();
  };
  const LoopResult result = loop.runOn(clock);

  const SafetyGate gate(p.safety, p.rate_hz);  // for its derived limits
  ASSERT_EQ(result.records.size(), static_cast<std::size_t>(ticks));
  ASSERT_LE(gate.fadeTicks(), kMostFadeTicks);
  ASSERT_NO_FATAL_FAILURE(checkEveryForce(device, p.safety, p.safety.slew_limit_N_per_s / p.rate_hz));
  ASSERT_NO_FATAL_FAILURE(checkFades(result.records, device, gate.fadeTicks(), seen));
  ASSERT_NO_FATAL_FAILURE(
      checkEnd(result.records.back(), algorithm.wanted_W, p.safety.force_limit_N, device.cut_N, seen));
}

TEST(FaultSequences, NoneLetsOutAForceThatIsNotWithinTheLimits) {
  WindowStorage storage(ScriptedEngine::kSide * ScriptedEngine::kSide * ScriptedEngine::kSide);
  Seen seen;
  for (int i = 0; i < kSequences; ++i) {
    SCOPED_TRACE("sequence " + std::to_string(i));
    ASSERT_NO_FATAL_FAILURE(playSequence(static_cast<unsigned>(i), storage, seen));
  }
  // That the sequences were worth something: each fading fault was raised, forces came back, the controller acted. An
  // unstable contact needs a tool that follows the force (instability_guard_test.cpp), and a plane is left behind by a
  // tool that outruns the surface over many windows' lengths (way_and_age_test.cpp): leaps as wide are not believed.
  constexpr std::uint32_t kPlayed = kFadingFaults & ~(bit(ServoFault::kUnstable) | bit(ServoFault::kPlaneBehind));
  EXPECT_EQ(seen.faults & kPlayed, kPlayed) << faultNames(seen.faults);
  EXPECT_GT(seen.back_to_the_wanted, kSequences / 2);
  EXPECT_GT(seen.pushing_at_the_end, kSequences / 2);
  EXPECT_GT(seen.fades_to_zero, kSequences / 4);
  EXPECT_GT(seen.damped_ticks, kSequences / 4);
  EXPECT_GT(seen.refused_while_holding, kSequences);
  EXPECT_GT(seen.cut_by_the_device, kSequences / 50);
  EXPECT_EQ(seen.algorithms.size(), algorithms().size());
}

}  // namespace fault_sequences_test
}  // namespace palpate
