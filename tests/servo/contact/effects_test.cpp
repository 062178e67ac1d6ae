// SPDX-License-Identifier: Apache-2.0
#include "servo/contact/effects.hpp"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "contact/plane_contact.hpp"
#include "servo/algorithms/registry.hpp"
#include "servo/contact/energy_account.hpp"
#include "servo/contact/force_shading.hpp"
#include "servo/contact/recovery.hpp"
#include "servo/contact/stiffness_by_density.hpp"
#include "servo/contact/texture.hpp"
#include "support/algorithm_driver.hpp"
#include "support/seeded.hpp"
#include "support/tick_watch.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace effects_test {

constexpr double kStiffness = 500;
constexpr double kRate = 1000;
const Vec3 kCentre = Vec3::Constant(31.3e-3);
constexpr double kRadius = 20e-3;

EffectParameters everything() {
  EffectParameters p;
  p.force_shading = true;
  p.recovery_s = 0.01;
  p.texture = TextureKind::kProcedural;
  p.friction = {0.5, 0.3, 0.2};
  p.stiffness_by_density = {{0, 0.5}, {5e-3, 2}};
  return p;
}

// One effect alone; the names are for messages.
struct Single {
  const char* name;
  EffectParameters parameters;
};
std::vector<Single> singles() {
  EffectParameters shading, recovery, procedural, density, friction, stiffness;
  shading.force_shading = true;
  recovery.recovery_s = 0.01;
  procedural.texture = TextureKind::kProcedural;
  density.texture = TextureKind::kDensity;
  friction.friction = {0.5, 0.3, 0.2};
  stiffness.stiffness_by_density = {{0, 0.5}, {5e-3, 2}};
  return {{"force shading", shading},   {"recovery", recovery}, {"procedural texture", procedural},
          {"density texture", density}, {"friction", friction}, {"stiffness", stiffness}};
}

AnalyticVolume bumpyBall() {
  return millimetreVolume([](const Vec3& p) {
    return kRadius - (p - kCentre).norm() + 0.05e-3 * std::sin(2e3 * p.x()) * std::sin(1.7e3 * p.y());
  });
}

// Over the ball's pole, in and out of contact, with planes of 5 ticks.
std::vector<TickOutput> touch(ContactEffects effects, const AnalyticVolume& volume, const Mat3& R = Mat3::Identity(),
                              const AlgorithmParameters& parameters = {}) {
  const auto algorithm = makeAlgorithm("hri", {.parameters = parameters, .effects = std::move(effects)});
  const auto at = [&](int i) {
    const double height_m = 1e-3 * std::cos(0.013 * i) - 0.5e-3;
    const double angle = 0.4 * std::sin(0.02 * i);
    return Vec3(R *
                (kCentre + Vec3(std::sin(angle), 0.1 * std::sin(0.03 * i), std::cos(angle)) * (kRadius + height_m)));
  };
  AlgorithmDriver driver(*algorithm, volume, at(0), 40);
  driver.follow = false;  // one window holds it all
  std::vector<TickOutput> outs;
  for (int i = 0; i < 1000; ++i) outs.push_back(driver.at(at(i)));
  return outs;
}

std::vector<TickOutput> touch(const EffectParameters& p) {
  return touch(makeContactEffects(p, kStiffness, kRate), bumpyBall());
}

double largestDifference_N(const std::vector<TickOutput>& a, const std::vector<TickOutput>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, (a[i].force_W - b[i].force_W).norm());
  return largest;
}

// ---- what is made, and in which order ----

TEST(Effects, WhatIsNotAskedForIsNotMade) {
  EXPECT_TRUE(makeContactEffects({}, kStiffness, kRate).empty());
  for (const Single& single : singles()) {
    EXPECT_EQ(makeContactEffects(single.parameters, kStiffness, kRate).size(), 1u) << single.name;
  }
}

TEST(Effects, AreMadeInTheStatedOrder) {
  for (const TextureKind texture : {TextureKind::kProcedural, TextureKind::kDensity}) {
    EffectParameters p = everything();
    p.texture = texture;
    const ContactEffects effects = makeContactEffects(p, kStiffness, kRate);
    ASSERT_EQ(effects.size(), 5u);
    EXPECT_NE(dynamic_cast<const ForceShading*>(effects[0].get()), nullptr);
    EXPECT_NE(dynamic_cast<const Recovery*>(effects[1].get()), nullptr);
    EXPECT_EQ(dynamic_cast<const ProceduralTexture*>(effects[2].get()) != nullptr, texture == TextureKind::kProcedural);
    EXPECT_EQ(dynamic_cast<const DensityTexture*>(effects[2].get()) != nullptr, texture == TextureKind::kDensity);
    EXPECT_NE(dynamic_cast<const Friction*>(effects[3].get()), nullptr);
    EXPECT_NE(dynamic_cast<const StiffnessByDensity*>(effects[4].get()), nullptr);
  }
}

// As many ticks as are nearest to it, at least one.
TEST(Effects, ARecoveryTakesItsTime) {
  const std::pair<double, int> ticksOf[] = {{0.01, 10}, {0.0104, 10}, {0.0106, 11}, {1e-5, 1}};
  for (const auto& [recovery_s, ticks] : ticksOf) {
    EffectParameters p;
    p.recovery_s = recovery_s;
    const ContactEffects effects = makeContactEffects(p, kStiffness, kRate);
    PlaneContact contact(*effects[0]);
    const Vec3 hip(0, 0, -1e-3);
    contact.at(hip);
    contact.renew({Vec3(0, 0, 0.5e-3), Vec3::UnitZ(), 0});
    int taken = 0;
    while (taken < 100 && contact.at(hip) != contact.plane_T.nearest(hip)) ++taken;
    EXPECT_EQ(taken, ticks) << recovery_s;
  }
}

// Any two neighbours the other way round give another force: by more than 1 mN, where rounding is 1e-12 N.
TEST(Effects, TheOrderMatters) {
  const std::vector<TickOutput> kept = touch(everything());
  for (std::size_t first = 0; first < 4; ++first) {
    ContactEffects effects = makeContactEffects(everything(), kStiffness, kRate);
    std::swap(effects[first], effects[first + 1]);
    EXPECT_GT(largestDifference_N(kept, touch(std::move(effects), bumpyBall())), 1e-3) << first;
  }
}

// Friction limits d to its cone, and stiffness, after it, keeps the angle of d: tangential to normal force stays within
// mu_s, whatever the factor. Without viscous friction, and without damping, which takes from the normal force alone.
TEST(Effects, StiffnessKeepsTheFrictionCone) {
  EffectParameters p;
  p.friction = {0.5, 0.5, 0};
  p.stiffness_by_density = {{1e-3, 0.2}, {3e-3, 2}};  // of one density everywhere under a level surface
  const AnalyticVolume level = millimetreVolume([](const Vec3& q) { return kCentre.z() + kRadius - q.z(); });
  AlgorithmParameters undamped;
  undamped.damping_Ns_per_m = 0;
  double widest = 0, most_N = 0;
  for (const TickOutput& out : touch(makeContactEffects(p, kStiffness, kRate), level, Mat3::Identity(), undamped)) {
    if (!out.in_contact) continue;
    const double along_N = out.normal_W.dot(out.force_W);
    const double aside_N = (out.force_W - along_N * out.normal_W).norm();
    ASSERT_LE(aside_N, 0.5 * along_N + 1e-6);  // float samples of 50e-3: slopes of 1e-7
    if (along_N > 0.01) widest = std::max(widest, aside_N / along_N);
    most_N = std::max(most_N, along_N);
  }
  EXPECT_GT(widest, 0.49);
  EXPECT_GT(most_N, 0.4);
}

// ---- every effect ----

TEST(Effects, EachChangesTheForceAndIsTheSameEveryTime) {
  const std::vector<TickOutput> plain = touch({});
  for (const Single& single : singles()) {
    const std::vector<TickOutput> once = touch(single.parameters);
    EXPECT_GT(largestDifference_N(plain, once), 1e-3) << single.name;
    EXPECT_EQ(largestDifference_N(once, touch(single.parameters)), 0) << single.name;
  }
}

// A scene turned in the world, with its samples bit for bit, gives the trace turned: forces of a newton to 1e-9. The
// procedural texture is fixed in the world, so it is not among them.
TEST(Effects, TurningTheSceneTurnsTheForce) {
  const Mat3 R = someRotation();
  const AnalyticVolume straight = bumpyBall();
  AnalyticVolume turned = straight;
  turned.lattice.R_WL = R;
  // Densities at the turned samples are those of the straight ones: by index, not by a position that rounds otherwise.
  const Lattice lattice = turned.lattice;
  turned.density = [straight, lattice](const Vec3& p) {
    const Vec3 index = lattice.toIndex(p).array().round();
    return straight.density(straight.lattice.toWorld(index));
  };
  for (const Single& single : singles()) {
    if (single.parameters.texture == TextureKind::kProcedural) continue;
    const auto a = touch(makeContactEffects(single.parameters, kStiffness, kRate), straight);
    const auto b = touch(makeContactEffects(single.parameters, kStiffness, kRate), turned, R);
    int in_contact = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      ASSERT_EQ(a[i].in_contact, b[i].in_contact) << single.name << " " << i;
      ASSERT_NEAR((R * a[i].force_W - b[i].force_W).norm(), 0, 1e-9) << single.name << " " << i;
      in_contact += a[i].in_contact ? 1 : 0;
    }
    EXPECT_GT(in_contact, 300);
  }
}

// Without a usable window, and far from a plane's usual values, the VHIP stays finite.
TEST(Effects, AreHarmlessWithoutAWindow) {
  for (const Single& single : singles()) {
    for (auto& effect : makeContactEffects(single.parameters, kStiffness, kRate)) {
      PlaneContact contact(*effect);
      int i = 0;
      for (const Vec3& hip : wander(2000)) {
        if (++i % 7 == 0) contact.renew({Vec3(0, 0, hip.x()), Vec3::UnitZ(), 0});
        if (i % 100 == 0) contact.leave();
        ASSERT_TRUE(contact.at(hip).allFinite()) << single.name;
      }
    }
  }
}

// A contact that begins anew is as the first: nothing of the last one is left.
TEST(Effects, ANewContactIsAsTheFirst) {
  const AnalyticVolume volume = bumpyBall();
  HeldWindow held;
  volume.hold(held, Vec3i::Zero(), volume.size);
  for (const Single& single : singles()) {
    ContactEffects effects = makeContactEffects(single.parameters, kStiffness, kRate);
    PlaneContact contact(*effects[0]);
    contact.window = &held.window;
    const ContactPlane pole{kCentre + Vec3(0, 0, kRadius), Vec3::UnitZ(), 0};
    const auto slide = [&] {
      std::vector<Vec3> vhips;
      for (int i = 0; i < 40; ++i) {
        if (i % 5 == 0) contact.renew({pole.p_W + Vec3(0, 0, 0.01e-3 * i), pole.normal_W, 0});
        vhips.push_back(contact.at(pole.p_W + Vec3(0.05e-3 * i, 0, -1e-3)));
      }
      return vhips;
    };
    const std::vector<Vec3> first = slide();
    contact.leave();
    const std::vector<Vec3> again = slide();
    for (std::size_t i = 0; i < first.size(); ++i) ASSERT_EQ(first[i], again[i]) << single.name << " " << i;
  }
}

// move() and release() are the servo's.
TEST(Effects, TakeNothingFromTheHeap) {
  const AnalyticVolume volume = bumpyBall();
  HeldWindow held;
  volume.hold(held, Vec3i::Zero(), volume.size);
  EffectParameters p = everything();
  ContactEffects effects = makeContactEffects(p, kStiffness, kRate);
  p.texture = TextureKind::kDensity;
  ContactEffects more = makeContactEffects(p, kStiffness, kRate);
  effects.push_back(std::move(more[2]));
  EnergyAccount account;
  FeltSurface felt(0, kRate);
  Vec3 sum = Vec3::Zero();
  TickWatch::begin();
  for (int i = 0; i < 1000; ++i) {
    held.window.version += i % 100 == 0 ? 1 : 0;
    ContactState contact;
    contact.plane = {kCentre + Vec3(0, 0, kRadius + 1e-6 * (i % 7)), Vec3::UnitZ(), i % 5};
    contact.hip_W = contact.plane.p_W + Vec3(1e-6 * i, 0, -1e-3);
    contact.new_contact = i % 300 == 0;
    contact.felt = felt.feel(
        {.hip_W = contact.hip_W, .plane = contact.plane, .begins = contact.new_contact, .window = &held.window});
    ContactPush push{.vhip_W = contact.plane.nearest(contact.hip_W), .energy_m2 = 0.5e-6};
    for (auto& effect : effects) effect->move(contact, push);
    push.vhip_W = account.settle(contact, push);
    if (i % 300 == 299) {
      felt.release();
      for (auto& effect : effects) effect->release();
    }
    sum += push.vhip_W;
  }
  TickWatch::end();
  EXPECT_EQ(TickWatch::seen().all(), 0);
  EXPECT_TRUE(sum.allFinite());
  TickWatch::begin();
  const auto deliberate = std::make_unique<Vec3>(sum);
  TickWatch::end();
  EXPECT_EQ(TickWatch::seen().allocations, 1);
  EXPECT_EQ(*deliberate, sum);
}

// The other algorithm with a plane takes them as well.
TEST(Effects, ActOnThePapersAlgorithmToo) {
  for (const Single& single : singles()) {
    double difference_N = 0;
    const AnalyticVolume volume = bumpyBall();
    const auto plain = makeAlgorithm("hri-paper", {});
    const auto with = makeAlgorithm(
        "hri-paper", {.parameters = {}, .effects = makeContactEffects(single.parameters, kStiffness, kRate)});
    const Vec3 start = kCentre + Vec3(0, 0, kRadius + 1e-3);
    AlgorithmDriver a(*plain, volume, start), b(*with, volume, start);
    a.follow = b.follow = false;
    for (int i = 0; i < 200; ++i) {
      const Vec3 hip = kCentre + Vec3(0.03e-3 * i, 0, kRadius + 1e-3 - 2e-3 * std::min(1.0, 0.02 * i));
      const TickOutput one = a.at(hip), other = b.at(hip);
      ASSERT_EQ(one.in_contact, other.in_contact);
      ASSERT_TRUE(other.force_W.allFinite());
      difference_N = std::max(difference_N, (one.force_W - other.force_W).norm());
    }
    EXPECT_GT(difference_N, 1e-3) << single.name;
  }
}

// Round a circle on a ball, D deep, friction takes 2 pi K lag sqrt(r^2 - lag^2) of work a turn (friction_test.cpp,
// where that is derived on a plane). Of that, 3 % may be missing: the depth errs by up to 0.02 voxel, 2 % of D, and the
// circle lies on a ball, whose tangent plane turns by lag / R = 1.5 % under the sled.
TEST(Effects, FrictionDissipatesOverALoopOnABall) {
  const AnalyticVolume volume = millimetreVolume(ball(kCentre, kRadius));
  const double depth_m = 1e-3, polar = 0.3, r = (kRadius - depth_m) * std::sin(polar);
  const int turn = 4000;
  EffectParameters p;
  p.friction = {0.4, 0.3, 0};
  const auto algorithm = makeAlgorithm("hri", {.parameters = {.damping_Ns_per_m = 0, .plane_renewal_ticks = 1},
                                               .effects = makeContactEffects(p, kStiffness, kRate)});
  const auto at = [&](int i, double radius_m) {
    const double angle = 2 * std::numbers::pi * i / turn;
    return Vec3(kCentre +
                radius_m * Vec3(std::sin(polar) * std::cos(angle), std::sin(polar) * std::sin(angle), std::cos(polar)));
  };
  AlgorithmDriver driver(*algorithm, volume, at(0, kRadius + 1e-3), 40);
  driver.stroke(at(0, kRadius - depth_m), 20);
  double work_J = 0;
  Vec3 force = Vec3::Zero();
  for (int i = 0; i <= 2 * turn; ++i) {
    if (i > turn) work_J += force.dot(at(i, kRadius - depth_m) - at(i - 1, kRadius - depth_m));
    force = driver.at(at(i, kRadius - depth_m)).force_W;
  }
  const double lag_m = 0.3 * depth_m;
  EXPECT_NEAR(work_J / (-2 * std::numbers::pi * kStiffness * lag_m * std::sqrt(r * r - lag_m * lag_m)), 1, 0.03);
}

// ---- refusals ----

std::string refusal(void (*change)(EffectParameters&), double stiffness_N_per_m = kStiffness, double rate_hz = kRate) {
  EffectParameters p;
  change(p);
  return refusalOf([&] { static_cast<void>(makeContactEffects(p, stiffness_N_per_m, rate_hz)); });
}

TEST(Effects, RefuseWhatCannotBeUsed) {
  using P = EffectParameters;
  const auto nothing = [](P&) {};
  EXPECT_EQ(refusal(nothing), "accepted");
  EXPECT_EQ(refusal(nothing, -1), "stiffness: -1 cannot be used; give 0 or more");
  EXPECT_EQ(refusal(nothing, kStiffness, 0), "rate: 0 cannot be used; give more than 0 Hz");
  EXPECT_EQ(refusal([](P& p) { p.recovery_s = -1; }), "recovery time: -1 cannot be used; give 0 or more");
  EXPECT_EQ(refusal([](P& p) { p.recovery_s = NAN; }), "recovery time: nan cannot be used; give 0 or more");
  EXPECT_EQ(refusal([](P& p) { p.recovery_s = 1e6; }), "recovery time: 1e+06 cannot be used; give a shorter time");
  EXPECT_EQ(refusal([](P& p) { p.texture_amplitude_m = -1; }), "texture amplitude: -1 cannot be used; give 0 or more");
  EXPECT_EQ(refusal([](P& p) { p.texture_wavelength_m = 0; }),
            "texture wavelength: 0 cannot be used; give more than 0 mm");
  EXPECT_EQ(refusal([](P& p) { p.texture_gain = INFINITY; }), "texture gain: inf cannot be used; give 0 or more");
  EXPECT_EQ(refusal([](P& p) { p.friction.static_ratio = -0.1; }),
            "static friction: -0.1 cannot be used; give 0 or more");
  EXPECT_EQ(refusal([](P& p) {
              p.friction = {0.3, -0.1, 0};
            }),
            "dynamic friction: -0.1 cannot be used; give 0 or more");
  EXPECT_EQ(refusal([](P& p) { p.friction.viscous_Ns_per_m = NAN; }),
            "viscous friction: nan cannot be used; give 0 or more");
  EXPECT_EQ(refusal([](P& p) {
              p.friction = {0.3, 0.4, 0};
            }),
            "dynamic friction: 0.4 cannot be used; give at most the static friction, 0.3");
  EXPECT_EQ(refusal([](P& p) {
              p.stiffness_by_density = {{1, -1}};
            }),
            "stiffness by density: factor -1 cannot be used; give one from 0 to 100");
}

// The names say what is made, in the same order.
TEST(Effects, NamesAreThoseOfTheEffectsThatAreMade) {
  EffectParameters p;
  EXPECT_EQ(contactEffectNames(p), "");
  p.friction.viscous_Ns_per_m = 1;
  EXPECT_EQ(contactEffectNames(p), "friction");
  p.friction = {0.3, 0.2, 0};
  p.texture = TextureKind::kDensity;
  p.recovery_s = 0.02;
  p.stiffness_by_density = {{0, 1}, {1, 2}};
  p.force_shading = true;
  EXPECT_EQ(contactEffectNames(p), "force shading, recovery time, texture, friction, stiffness by density");
  EXPECT_EQ(makeContactEffects(p, kStiffness, kRate).size(), 5U);
}

// The change of the force along the normal with the depth, over K, at random places of a plane: never more than is
// said, and where the bumps are high nearly so much.
TEST(Effects, StiffenTheContactByNoMoreThanTheySay) {
  Seeded random(31);
  for (const double factor : {0.0, 3.0}) {  // of a table; 0: none
    EffectParameters p{.texture = TextureKind::kProcedural, .texture_amplitude_m = 0.1e-3};
    if (factor > 0) p.stiffness_by_density = {{0, 0.5}, {1, factor}};
    const double said = mostStiffening(p);
    p.stiffness_by_density.clear();  // it reads the volume
    ContactEffects effects = makeContactEffects(p, kStiffness, kRate);
    double most = 0;
    for (int i = 0; i < 20000; ++i) {
      const Vec3 at_W = random.inCube(5e-3);
      const double depth_m = random.between(1e-6, 0.4e-3), step_m = 1e-8;
      const auto pushed = [&](double deep_m) {
        ContactState contact;
        contact.plane = {Vec3(at_W.x(), at_W.y(), 0), Vec3(0, 0, 1), 0};
        contact.hip_W = Vec3(at_W.x(), at_W.y(), -deep_m);
        contact.on_volume = false;
        contact.felt.p_W = contact.felt.place_W = contact.plane.p_W;
        contact.felt.normal_W = contact.plane.normal_W;
        contact.felt.depth_m = deep_m;
        contact.felt.shape = ShapeOperator(contact.plane.normal_W);
        ContactPush push{.vhip_W = contact.plane.p_W, .energy_m2 = 0.5 * deep_m * deep_m};
        effects.front()->move(contact, push);
        return push.vhip_W.z() + deep_m;
      };
      most = std::max(most, std::abs(pushed(depth_m + step_m) - pushed(depth_m)) / step_m);
    }
    most *= std::max(1.0, factor);
    EXPECT_LE(most, said);
    EXPECT_GT(most, 0.75 * said);
  }
  EffectParameters p;
  EXPECT_EQ(mostStiffening(p), 1);
  p.force_shading = true;
  EXPECT_NEAR(mostStiffening(p), 2 / std::sqrt(3.0), 1e-5);
  p.stiffness_by_density = {{0, 0.25}, {1, 0.5}};
  EXPECT_NEAR(mostStiffening(p), 2 / std::sqrt(3.0), 1e-5);  // objects keep all of K
}

// Friction holds by K; a texture by K for its bend and 0.54 K for its slope; both by more where the ground is hard, by
// its factor. A border between two materials holds by K.
TEST(Effects, HoldAsideByAsMuchAsTheyState) {
  EffectParameters p;
  EXPECT_EQ(mostStiffeningAside(p), 0);
  p.force_shading = true;
  p.recovery_s = 0.1;
  EXPECT_EQ(mostStiffeningAside(p), 0);
  p.stiffness_by_density = {{0, 2}};
  EXPECT_EQ(mostStiffeningAside(p), 0);  // the same everywhere
  p.stiffness_by_density = {{0, 0.5}, {1, 2}};
  EXPECT_EQ(mostStiffeningAside(p), 1);
  p.texture = TextureKind::kProcedural;
  EXPECT_NEAR(mostStiffeningAside(p), 1 + 2 * 1.54, 0.01);
  p.texture_amplitude_m = 0;
  EXPECT_EQ(mostStiffeningAside(p), 1);
  p.friction.static_ratio = 0.1;
  EXPECT_EQ(mostStiffeningAside(p), 1 + 2);
  p.texture_amplitude_m = 1e-3;
  EXPECT_NEAR(mostStiffeningAside(p), 1 + 2 * 2.54, 0.01);
  p = {.texture = TextureKind::kDensity};
  EXPECT_NEAR(mostStiffeningAside(p), 1.54, 0.01);
}

TEST(Effects, TexturesByName) {
  EXPECT_EQ(textureOfName("none"), TextureKind::kNone);
  EXPECT_EQ(textureOfName("procedural"), TextureKind::kProcedural);
  EXPECT_EQ(textureOfName("density"), TextureKind::kDensity);
  EXPECT_THROW(static_cast<void>(textureOfName("velvet")), Error);
}

}  // namespace effects_test
}  // namespace palpate
