// SPDX-License-Identifier: Apache-2.0
// Warnings before the first tick: given where the sampled loop does not settle soon and nowhere else, and with the
// values that they name it does.
#include "apps/servo_setup/contact_bounds.hpp"

#include <cmath>
#include <regex>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "servo/devices/simulated_device.hpp"
#include "servo/devices/typical_hands.hpp"
#include "servo/loop/velocity_filter.hpp"
#include "servo/stability/sampled_loop.hpp"
#include "tests/servo/support/seeded.hpp"

namespace palpate {
namespace contact_bounds_test {

using testing::HasSubstr;

class Still final : public Path {
 public:
  [[nodiscard]] Vec3 position(double) const noexcept override { return Vec3::Zero(); }
  [[nodiscard]] double duration_s() const noexcept override { return 1; }
};
const Still kStill;

SimulatedDevice deviceIn(const HandParameters& hand, int delay_ticks, double rate_hz) {
  SimulatedDeviceParameters p;
  p.hand = Hand::kSpring;
  p.dynamics = hand;
  p.delay_ticks = delay_ticks;
  p.encoder_resolution_m = 0;
  return {p, kStill, rate_hz};
}

// The number behind the words, as the message has it.
double numberAfter(const std::string& text, const std::string& words) {
  std::smatch found;
  const std::regex pattern(words + "([0-9.e+-]+)");
  return std::regex_search(text, found, pattern) ? std::stod(found[1]) : std::nan("");
}

// A device in an ordinary hand, with what its maker states and what it is made of.
class Made final : public Device {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "made"; }
  [[nodiscard]] DeviceLimits limits() const noexcept override { return of; }
  [[nodiscard]] std::vector<HandParameters> hands() const override {
    return {{.device_friction_N = friction_N}, {.device_friction_N = 10 * friction_N}};
  }
  [[nodiscard]] bool read(Vec3&) noexcept override { return false; }
  [[nodiscard]] bool write(const Vec3&) noexcept override { return false; }
  DeviceLimits of;
  double friction_N = 0;
};

TEST(ContactBounds, WarnWhereTheLoopDoesNotSettleAndNameValuesWithWhichItDoes) {
  Seeded random(31);
  int stiff = 0, damped = 0, fine = 0, rates = 0, delays = 0;
  for (int i = 0; i < 400; ++i) {
    SampledLoop loop;
    loop.hand = kTypicalHands[static_cast<std::size_t>(random.pick(3))].holding(
        {.device_mass_kg = random.logBetween(0.01, 10), .device_damping_Ns_per_m = random.logBetween(0.01, 5)});
    loop.rate_hz = random.logBetween(100, 20000);
    loop.delay_ticks = random.pick(4);
    const SimulatedDevice device = deviceIn(loop.hand, loop.delay_ticks, loop.rate_hz);
    RigSettings settings;
    settings.parameters.stiffness_N_per_m = random.logBetween(50, 50000);
    settings.parameters.damping_Ns_per_m = random.pick(3) == 0 ? random.logBetween(10, 1000) : random.between(0, 5);
    if (random.pick(3) == 0) settings.effects.stiffness_by_density = {{0, 0.5}, {1, random.between(1, 5)}};
    LoopParameters parameters;
    parameters.rate_hz = loop.rate_hz;
    if (random.pick(4) == 0) settings.effects.texture = TextureKind::kProcedural;
    if (random.pick(4) == 0) settings.effects.friction = {0.3, 0.2, 0};
    const double factor = mostStiffening(settings.effects), damping = settings.parameters.damping_Ns_per_m;
    const Wall wall{settings.parameters.stiffness_N_per_m * factor, damping};
    const double held_aside = mostStiffeningAside(settings.effects);
    const Wall aside = held_aside > 0 ? Wall{settings.parameters.stiffness_N_per_m * held_aside, 0} : wall;
    const bool settles = settlesSoon(loop, wall) && settlesSoon(loop, aside);

    EXPECT_EQ(mayShake(settings, parameters, device), !settles) << i;
    const std::vector<std::string> warnings = boundWarnings(settings, parameters, device);
    ASSERT_EQ(warnings.size(), settles ? 0U : 1U) << i;
    const bool is_stable = isStable(loop, wall) && isStable(loop, aside);
    ASSERT_TRUE(is_stable || !warnings.empty()) << i;
    if (warnings.empty()) {
      ++fine;
      continue;
    }
    // What is named ends the warning: a rate, a delay, and below a stiffness or a damping.
    const Wall worse = warnings[0].find("along the surface") != std::string::npos ? aside : wall;
    const double least_rate_hz = numberAfter(warnings[0], "a rate of ");
    if (!std::isnan(least_rate_hz)) {
      ++rates;
      LoopParameters fast = parameters;
      fast.rate_hz = least_rate_hz;
      EXPECT_FALSE(mayShake(settings, fast, device)) << warnings[0];
    }
    const double most_delay = numberAfter(warnings[0], "a delay of at most ");
    if (!std::isnan(most_delay)) {
      ++delays;
      EXPECT_FALSE(mayShake(settings, parameters, deviceIn(loop.hand, static_cast<int>(most_delay), loop.rate_hz)))
          << warnings[0];
    }
    if (const double safe = numberAfter(warnings[0], "settles up to "); !std::isnan(safe)) {
      ++stiff;
      RigSettings softer = settings;
      softer.parameters.stiffness_N_per_m = safe;
      EXPECT_FALSE(mayShake(softer, parameters, device)) << warnings[0];
      softer.parameters.stiffness_N_per_m = safe * 1.12;  // two digits of it
      EXPECT_TRUE(mayShake(softer, parameters, device)) << warnings[0];
      EXPECT_THAT(warnings[0], HasSubstr(isStable(loop, worse) ? "may swing for long" : "will shake"));
    } else {
      ++damped;
      const double safe_damping = numberAfter(warnings[0], "give at most ");
      EXPECT_GT(settlingStiffness(loop, safe_damping), 0) << warnings[0];
      EXPECT_LE(safe_damping, usefulDamping(loop)) << warnings[0];
      EXPECT_LT(renderableDamping(settings, parameters, device), damping) << warnings[0];
      // Both values that are named end every warning.
      RigSettings told = settings;
      told.parameters.damping_Ns_per_m = safe_damping;
      const double softer = numberAfter(warnings[0], "with a stiffness of at most ");
      if (!std::isnan(softer)) told.parameters.stiffness_N_per_m = softer;
      EXPECT_THAT(boundWarnings(told, parameters, device), testing::IsEmpty()) << warnings[0];
      EXPECT_EQ(settlingStiffness(loop, damping), 0) << warnings[0];
    }
  }
  for (const int count : {stiff, damped, fine, rates, delays}) EXPECT_GT(count, 15);
}

TEST(ContactBounds, TellWhatIsBeyondAndWhatWouldBeSafe) {
  const SimulatedDevice device = deviceIn({}, 2, 1000);
  RigSettings settings;
  settings.parameters.stiffness_N_per_m = 10000;
  const std::vector<std::string> warnings = boundWarnings(settings, {}, device);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_THAT(warnings[0],
              HasSubstr("a stiffness of 10000 N/m is more than this device can render at 1000 Hz and 2 ticks "
                        "late, so the contact will shake: with a damping of 0.5 N s/m it settles up to "));
}

TEST(ContactBounds, SayNothingWhereNothingIsKnown) {
  RigSettings settings;
  settings.parameters.stiffness_N_per_m = 1e5;
  const SimulatedDevice rigid(SimulatedDeviceParameters{}, kStill, 1000);
  EXPECT_TRUE(mayShake(settings, {}, rigid));
  EXPECT_TRUE(boundWarnings(settings, {}, rigid).empty());
  settings.algorithm = "haptization";
  EXPECT_TRUE(mayShake(settings, {}, deviceIn({}, 0, 1000)));
  EXPECT_TRUE(boundWarnings(settings, {}, deviceIn({}, 0, 1000)).empty());
}

// It bears more in some contacts, and no more in others.
TEST(ContactBounds, ThePassivityControllerDoesNotSilenceThem) {
  RigSettings settings;
  settings.parameters.stiffness_N_per_m = 1e5;
  LoopParameters loop;
  const SimulatedDevice device = deviceIn({}, 0, 1000);
  const std::vector<std::string> without = boundWarnings(settings, loop, device);
  loop.passivity.control = true;
  const std::vector<std::string> with = boundWarnings(settings, loop, device);
  ASSERT_EQ(with.size(), 1U);
  EXPECT_EQ(with[0], without.at(0) + ". The passivity controller lessens that, but not in every contact");
  settings.parameters.stiffness_N_per_m = 500;
  EXPECT_THAT(boundWarnings(settings, loop, device), testing::IsEmpty());
}

// Where facets meet, the god-object's contact is felt stiffer than asked.
TEST(ContactBounds, CountWhatTheAlgorithmMakesOfAStiffness) {
  RigSettings settings;
  const SimulatedDevice device = deviceIn({}, 0, 1000);
  const double smooth = renderableStiffness(settings, {}, device);
  settings.algorithm = "god-object";
  EXPECT_NEAR(renderableStiffness(settings, {}, device), smooth / 1.3, 1e-3 * smooth);
}

// What a damping does that no wall bears: by itself, too late, or by the encoders' steps. 150 g at 1 kHz brake with up
// to 0.15 / (1 / 1000 + 1 / (2 pi 200)) = 83.5 N s/m.
TEST(ContactBounds, TellWhyADampingIsTooMuch) {
  RigSettings settings;
  const auto warning = [&](double damping_Ns_per_m, double resolution_m) {
    settings.parameters.damping_Ns_per_m = damping_Ns_per_m;
    Made device;
    device.of.position_resolution_m = resolution_m;
    const std::vector<std::string> all = boundWarnings(settings, {}, device);
    return all.empty() ? std::string() : all[0];
  };
  EXPECT_EQ(warning(83, 0), "");
  EXPECT_THAT(warning(84, 0), HasSubstr("a damping of 84 N s/m is more than this device can render at 1000 Hz, as it "
                                        "comes too late to brake, so the contact may swing at any stiffness; give at "
                                        "most 83 N s/m"));
  EXPECT_THAT(warning(2000, 0),
              HasSubstr("1000 Hz, so the contact will shake at any stiffness; give at most 83 N s/m"));
  EXPECT_THAT(warning(60, 50e-6), HasSubstr("so the contact may swing on at any stiffness, as a step of its encoders, "
                                            "50 um, makes the force jump by 2.1 N and friction quiets 0.04 N; give"));
}

// At a delay of ten seconds as at one of none. The softer wall is stable there: K b L < pi / 2 at least tenfold, with
// the damping b of device and hand and the delay L.
TEST(ContactBounds, HoldForAnyDelay) {
  const HandParameters hand = kTypicalHands[0].holding({.device_mass_kg = 0.05, .device_damping_Ns_per_m = 2});
  const LoopParameters loop;
  for (const int delay_ticks : {0, 1, 64, 65, 1000, 10000}) {
    const SimulatedDevice device = deviceIn(hand, delay_ticks, loop.rate_hz);
    RigSettings soft;
    soft.parameters.stiffness_N_per_m = 0.1 * 2 / (0.001 + delay_ticks / loop.rate_hz);
    soft.parameters.damping_Ns_per_m = 0;
    EXPECT_FALSE(mayShake(soft, loop, device)) << delay_ticks;
    EXPECT_THAT(boundWarnings(soft, loop, device), testing::IsEmpty()) << delay_ticks;
    RigSettings stiff = soft;
    stiff.parameters.stiffness_N_per_m = 50000;
    EXPECT_TRUE(mayShake(stiff, loop, device)) << delay_ticks;
    EXPECT_THAT(boundWarnings(stiff, loop, device), testing::SizeIs(1)) << delay_ticks;
  }
}

// An adaptive window may be a single tick: no low-pass.
TEST(ContactBounds, AnAdaptiveVelocityCountsAsItsShortestWindow) {
  LoopParameters foaw;
  foaw.velocity.name = "foaw";
  SampledLoop bare;
  bare.velocity_cutoff_hz = 0;
  const SimulatedDevice device = deviceIn({}, 0, 1000);
  for (const double damping : {0.0, 20.0}) {
    RigSettings settings;
    settings.parameters.damping_Ns_per_m = damping;
    const double bound = settlingStiffness(bare, damping);
    settings.parameters.stiffness_N_per_m = 0.99 * bound;
    EXPECT_FALSE(mayShake(settings, foaw, device));
    settings.parameters.stiffness_N_per_m = 1.01 * bound;
    EXPECT_TRUE(mayShake(settings, foaw, device));
  }
}

// With encoders of any size: warned where the wall is unstable without its damping and a step makes the force jump by
// more than dry friction quiets, and the stiffness that is named is neither. The jump is made here by the servo's
// filter.
TEST(ContactBounds, AStepOfTheEncodersIsAnsweredByLessThanFrictionQuiets) {
  Seeded random(33);
  int stiff = 0, damped = 0, fine = 0, undamped = 0;
  for (int i = 0; i < 1500; ++i) {
    Made device;
    device.of.position_resolution_m = random.logBetween(1e-6, 100e-6);
    device.friction_N = random.pick(2) == 0 ? 0 : random.logBetween(0.005, 0.3);
    RigSettings settings;
    settings.parameters.stiffness_N_per_m = random.logBetween(1000, 20000);
    settings.parameters.damping_Ns_per_m = random.between(0, 20);
    if (random.pick(3) == 0) settings.effects.stiffness_by_density = {{1, random.between(1, 5)}};
    LoopParameters loop;
    loop.rate_hz = random.logBetween(500, 4000);
    VelocityFilter filter(loop.velocity.cutoff_hz, loop.rate_hz);
    filter.reset(Vec3::Zero());
    const double speed_m_per_s = filter.update({device.of.position_resolution_m, 0, 0}, 1).x();
    const double quiet_N = 2 * std::max(0.02, device.friction_N);
    const double factor = mostStiffening(settings.effects), gain = 4 / M_PI;  // of rounding, in the linear loop
    const SampledLoop sampled{.hand = device.hands()[0], .rate_hz = loop.rate_hz};
    const auto jump_N = [&](double stiffness) {
      return stiffness * factor * device.of.position_resolution_m +
             settings.parameters.damping_Ns_per_m * speed_m_per_s;
    };
    const bool overdamped = settings.parameters.damping_Ns_per_m * speed_m_per_s > 5 * quiet_N;
    const auto swings = [&](double stiffness) {
      return overdamped || jump_N(stiffness) > 10 * quiet_N ||
             (jump_N(stiffness) > quiet_N && !isStable(sampled, {stiffness * factor, 0}));
    };
    const double stiffness = settings.parameters.stiffness_N_per_m;
    const bool settles = settlesSoon(sampled, {gain * stiffness * factor, gain * settings.parameters.damping_Ns_per_m});
    const std::vector<std::string> warnings = boundWarnings(settings, loop, device);
    if (!settles) {
      EXPECT_EQ(warnings.size(), 1U) << i;
      continue;
    }
    ASSERT_EQ(warnings.empty(), !swings(stiffness)) << i;
    EXPECT_EQ(mayShake(settings, loop, device), !warnings.empty()) << i;
    if (warnings.empty()) {
      ++fine;
      undamped += jump_N(stiffness) > quiet_N ? 1 : 0;
      continue;
    }
    EXPECT_THAT(warnings[0], HasSubstr("so the contact may swing on"));
    if (overdamped) {
      ++damped;
      const double safe = numberAfter(warnings[0], "give at most ");
      EXPECT_LE(safe * speed_m_per_s, 5 * quiet_N) << warnings[0];
      // Two digits; half of what is borne where only that leaves room for the stiffness.
      EXPECT_GT(safe * 2.24 * speed_m_per_s, 5 * quiet_N) << warnings[0];
      continue;
    }
    ++stiff;
    EXPECT_NEAR(numberAfter(warnings[0], "makes the force jump by "), jump_N(stiffness), 0.06 * jump_N(stiffness));
    EXPECT_NEAR(numberAfter(warnings[0], "friction quiets "), quiet_N, 0.06 * quiet_N);
    const double safe = numberAfter(warnings[0], "settles up to ");
    EXPECT_FALSE(swings(safe * 0.999)) << warnings[0];
    EXPECT_TRUE(swings(safe * 1.12)) << warnings[0];  // two digits
  }
  for (const int count : {stiff, damped, fine, undamped}) EXPECT_GT(count, 15);
}

// A device that knows several hands is judged by the worst.
class AnyHand final : public Device {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "any hand"; }
  [[nodiscard]] DeviceLimits limits() const noexcept override { return {}; }
  [[nodiscard]] std::vector<HandParameters> hands() const override {
    std::vector<HandParameters> all;
    for (const TypicalHand& hand : kTypicalHands) all.push_back(hand.holding({}));
    return all;
  }
  [[nodiscard]] bool read(Vec3&) noexcept override { return false; }
  [[nodiscard]] bool write(const Vec3&) noexcept override { return false; }
};

TEST(ContactBounds, TheUsualStiffnessIsTheMakersAndWhatTheDeviceCanRender) {
  RigSettings settings;
  settings.parameters.stiffness_N_per_m = 500;
  settings.parameters.damping_Ns_per_m = 0.5;
  LoopParameters loop;
  Made made;
  const double most = renderableStiffness(settings, loop, made);
  ASSERT_GT(most, 1000);
  EXPECT_EQ(usualStiffness(settings, loop, made), 500);  // the maker states nothing
  made.of.stiffness_limit_N_per_m = 900;
  EXPECT_EQ(usualStiffness(settings, loop, made), 900);
  made.of.stiffness_limit_N_per_m = 300;
  EXPECT_EQ(usualStiffness(settings, loop, made), 300);
  made.of.stiffness_limit_N_per_m = 0.5;  // at the handle of a device that is placed at a large scale
  EXPECT_EQ(usualStiffness(settings, loop, made), 0.5);
  made.of.stiffness_limit_N_per_m = 1e6;
  const double rendered = usualStiffness(settings, loop, made);
  EXPECT_LE(rendered, most);
  EXPECT_GT(rendered, 0.9 * most);  // two digits
  // 2 f / D of the hand in which it is least: 2 * 0.02 / 50e-6.
  made.friction_N = 0.02;
  made.of.position_resolution_m = 50e-6;
  EXPECT_EQ(usualStiffness(settings, loop, made), 800);
  made.of.position_resolution_m = 0;  // nothing is rounded
  EXPECT_EQ(usualStiffness(settings, loop, made), rendered);
  // Where the density makes it three times as stiff, that is what must be stable, and nothing is warned about.
  settings.effects.stiffness_by_density = {{0, 1}, {100, 3}};
  EXPECT_NEAR(usualStiffness(settings, loop, made), rendered / 3, 0.1 * rendered / 3);
  RigSettings chosen = settings;
  chosen.parameters.stiffness_N_per_m = usualStiffness(settings, loop, made);
  EXPECT_THAT(boundWarnings(chosen, loop, made), testing::IsEmpty());
  settings.effects.stiffness_by_density.clear();
  // A damping with which nothing is stable: it is warned about, and the wall does not vanish.
  settings.parameters.damping_Ns_per_m = 1000;
  made.of.stiffness_limit_N_per_m = 900;
  ASSERT_EQ(renderableStiffness(settings, loop, made), 0);
  EXPECT_EQ(usualStiffness(settings, loop, made), 900);
  EXPECT_EQ(boundWarnings(settings, loop, made).size(), 1U);
  made.of.follows_force = false;  // nothing can shake
  EXPECT_EQ(usualStiffness(settings, loop, made), 500);
}

// What still brakes the worst hand, where that is less than what is asked for: with it some wall is stable, and nothing
// is warned about.
TEST(ContactBounds, TheUsualDampingLeavesAWall) {
  RigSettings settings;
  settings.parameters.damping_Ns_per_m = 0.5;
  LoopParameters loop;
  const AnyHand device;
  EXPECT_EQ(usualDamping(settings, loop, device), 0.5);
  loop.rate_hz = 20;  // slow enough that the usual damping is beyond
  settings.parameters.rate_hz = 20;
  double least = 1e9;
  for (const TypicalHand& hand : kTypicalHands)
    least = std::min(least, usefulDamping({.hand = hand.holding({}), .rate_hz = 20}));
  settings.parameters.damping_Ns_per_m = 10 * least;
  const double damping = usualDamping(settings, loop, device);
  EXPECT_LE(damping, least);
  EXPECT_GT(damping, 0.9 * least);
  settings.parameters.damping_Ns_per_m = damping;
  settings.parameters.stiffness_N_per_m = usualStiffness(settings, loop, device);
  EXPECT_GT(settings.parameters.stiffness_N_per_m, 0);
  EXPECT_THAT(boundWarnings(settings, loop, device), testing::IsEmpty());
  settings.algorithm = "haptization";
  settings.parameters.damping_Ns_per_m = 10 * least;
  EXPECT_EQ(usualDamping(settings, loop, device), 10 * least);
}

TEST(ContactBounds, TheWorstHandCounts) {
  double worst = 1e9, best = 0;
  for (const TypicalHand& hand : kTypicalHands) {
    const double bound = settlingStiffness({.hand = hand.holding({})}, 0.5);
    worst = std::min(worst, bound);
    best = std::max(best, bound);
  }
  ASSERT_LT(1.5 * worst, best);
  RigSettings settings;
  settings.parameters.stiffness_N_per_m = 1.2 * worst;
  const std::vector<std::string> warnings = boundWarnings(settings, {}, AnyHand{});
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NEAR(numberAfter(warnings[0], "settles up to "), worst, 0.1 * worst);
  settings.parameters.stiffness_N_per_m = 0.9 * worst;
  EXPECT_FALSE(mayShake(settings, {}, AnyHand{}));
}

}  // namespace contact_bounds_test
}  // namespace palpate
