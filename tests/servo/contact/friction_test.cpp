// SPDX-License-Identifier: Apache-2.0
#include "servo/contact/friction.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "contact/plane_contact.hpp"

namespace palpate {
namespace friction_test {

constexpr double kStiffness = 500;  // [N/m]
constexpr double kRate = 1000;      // [Hz]
constexpr double kDepth = 1e-3;     // [m]
constexpr double kStatic = 0.6;
constexpr double kDynamic = 0.4;

Friction dry() {
  return {{kStatic, kDynamic, 0}, kStiffness, kRate};
}

double aside(const Vec3& v) {
  return std::hypot(v.x(), v.y());
}

// Lengths of some millimetres, in double: rounding is below 1e-17 m.
constexpr double kRounding_m = 1e-16;

// Tangential to normal force is the lag to the depth: never above mu_s, whatever the tool does; and it comes near it.
TEST(Friction, TheForceStaysInTheStaticCone) {
  Friction friction = dry();
  PlaneContact contact(friction);
  double largest = 0;
  for (const Vec3& hip : wander(20000)) {
    const Vec3 vhip = contact.at(hip);
    ASSERT_NEAR(vhip.z(), 0, kRounding_m);  // it moves the VHIP on the plane only
    ASSERT_LE(aside(vhip - hip), kStatic * -hip.z() + kRounding_m);
    if (hip.z() < -0.2e-3) largest = std::max(largest, aside(vhip - hip) / -hip.z());
  }
  EXPECT_GT(largest, 0.98 * kStatic);
}

// Sticks up to mu_s D, to the last micrometre; then the lag falls to mu_d D in one tick and stays there.
TEST(Friction, BreaksAwayAtTheStaticConeAndSlipsAtTheDynamicOne) {
  Friction friction = dry();
  PlaneContact contact(friction);
  contact.at({0, 0, -kDepth});
  int stuck = 0;
  while (contact.at({(stuck + 1) * 1e-6, 0, -kDepth}).x() == 0) ++stuck;
  EXPECT_NEAR(stuck * 1e-6, kStatic * kDepth, 1.01e-6);
  for (int i = stuck + 2; i < stuck + 100; ++i) {
    EXPECT_NEAR(i * 1e-6 - contact.at({i * 1e-6, 0, -kDepth}).x(), kDynamic * kDepth, kRounding_m);
  }
}

// When it has stopped, the sled sticks again: it must be drawn to mu_s D once more. Backwards that is (mu_d + mu_s) D.
TEST(Friction, SticksAgainWhenItHasStopped) {
  Friction friction = dry();
  PlaneContact contact(friction);
  contact.at({0, 0, -kDepth});
  const double stop_m = 3e-3;
  for (int i = 1; i <= 300; ++i) contact.at({i * 1e-5, 0, -kDepth});
  const double sled_m = contact.at({stop_m, 0, -kDepth}).x();
  EXPECT_NEAR(sled_m, stop_m - kDynamic * kDepth, kRounding_m);
  const double nearly = 0.999 * kDepth;
  EXPECT_EQ(contact.at({sled_m + kStatic * nearly, 0, -kDepth}).x(), sled_m);
  EXPECT_EQ(contact.at({sled_m - kStatic * nearly, 0, -kDepth}).x(), sled_m);
  EXPECT_NEAR(contact.at({sled_m - kStatic * 1.001 * kDepth, 0, -kDepth}).x(),
              sled_m - kStatic * 1.001 * kDepth + kDynamic * kDepth, kRounding_m);
}

// Steady slip costs mu_d K D + b_v v. The lag settles by (1 - share) each tick, share = K T / (K T + b_v) = 0.2 here:
// after 200 ticks 1e-19 of it is left.
TEST(Friction, SteadySlipCostsDynamicAndViscousForceExactly) {
  for (const double viscous : {0.0, 2.0}) {
    Friction friction({kStatic, kDynamic, viscous}, kStiffness, kRate);
    PlaneContact contact(friction);
    const double speed_m_per_s = 0.1;
    Vec3 vhip, hip;
    for (int i = 0; i < 300; ++i) {
      hip = {i * speed_m_per_s / kRate, 0, -kDepth};
      vhip = contact.at(hip);
    }
    const double force_N = kStiffness * (hip - vhip).x();
    EXPECT_NEAR(force_N, kDynamic * kStiffness * kDepth + viscous * speed_m_per_s, kStiffness * kRounding_m * 10);
  }
}

// A sled of mass M (the device), pressed on the plane with K D, drawn by a spring k whose end moves at speed u, slowly;
// c damps it. Closed form for u -> 0, omega = sqrt(k / M), zeta = c / (2 sqrt(k M)):
//   slip: from the spring's stretch mu_s N / k down by a (1 + e), a = (mu_s - mu_d) N / k, e = exp(-pi zeta / s),
//   s = sqrt(1 - zeta^2), in the time pi / (omega s);
//   stick: the spring, in series with the contact's spring K, is stretched again at the rate u, until the contact's lag
//   has grown from mu_d D to mu_s D: [(mu_s - mu_d) D + a (1 + e)] / u.
// The corrections: u / (a omega) = 0.4 % in the slip, T omega = 0.1 % in the integration (first order), and the tick in
// which it breaks away: below 1 % together. In the stick the sled swings on K with sqrt((K + k) / M), damped over
// 2 M / c = 1 / (zeta omega), 300 times shorter than the stick.
TEST(Friction, StickSlipHasThePeriodAndAmplitudeOfTheClosedForm) {
  const double k = 20, mass = 0.2, omega = std::sqrt(k / mass), zeta = 0.2, c = 2 * zeta * std::sqrt(k * mass);
  const double T = 1e-3 / omega;
  const double a = (kStatic - kDynamic) * kStiffness * kDepth / k;
  const double u = 0.004 * a * omega;
  const double s = std::sqrt(1 - zeta * zeta), e = std::exp(-std::numbers::pi * zeta / s);

  Friction friction({kStatic, kDynamic, 0}, kStiffness, 1 / T);
  PlaneContact contact(friction);
  contact.at({0, 0, -kDepth});
  double x = 0, v = 0, vhip = 0, stretch = 0, highest = 0, lowest = 0;
  std::vector<double> breaks_s, drops_m;
  bool was_slipping = false;
  int still_ticks = 0;
  for (std::int64_t i = 1; breaks_s.size() < 4 && i < 5'000'000; ++i) {
    const double t = static_cast<double>(i) * T;
    const double vhip_before = vhip;
    vhip = contact.at({x, 0, -kDepth}).x();
    stretch = u * t - x;
    still_ticks = vhip == vhip_before ? still_ticks + 1 : 0;
    const bool slipping = still_ticks < 100;
    if (slipping && !was_slipping) {
      if (!breaks_s.empty()) drops_m.push_back(highest - lowest);
      breaks_s.push_back(t);
      highest = lowest = stretch;
    }
    if (slipping) lowest = std::min(lowest, stretch);
    was_slipping = slipping;
    v += T / mass * (k * stretch - kStiffness * (x - vhip) - c * v);
    x += T * v;
  }
  ASSERT_EQ(breaks_s.size(), 4u);
  const double drop_m = a * (1 + e);
  const double period_s = ((kStatic - kDynamic) * kDepth + drop_m) / u + std::numbers::pi / (omega * s);
  for (int i = 1; i < 3; ++i) {
    EXPECT_NEAR(drops_m[static_cast<std::size_t>(i)] / drop_m, 1, 0.01);
    EXPECT_NEAR((breaks_s[static_cast<std::size_t>(i) + 1] - breaks_s[static_cast<std::size_t>(i)]) / period_s, 1,
                0.01);
  }
}

// Round and round on a circle of radius r, the sled runs on the circle of radius sqrt(r^2 - lag^2), to which the lag is
// tangent: the force's work on the tool is -2 pi K lag sqrt(r^2 - lag^2) a turn. Each of the 20,000 steps of the sum
// errs by the angle between chord and arc and by the sled's way in a tick, both below 2 pi / 20000 = 3e-4.
TEST(Friction, DissipatesOverAClosedLoop) {
  Friction friction = dry();
  PlaneContact contact(friction);
  const double r = 5e-3, lag_m = kDynamic * kDepth;
  const int turn = 20000;
  const auto at = [&](int i) {
    const double angle = 2 * std::numbers::pi * i / turn;
    return Vec3(r * std::cos(angle), r * std::sin(angle), -kDepth);
  };
  double work_J = 0;
  Vec3 force = Vec3::Zero();
  for (int i = 0; i <= 2 * turn; ++i) {
    if (i > turn) work_J += force.dot(at(i) - at(i - 1));  // held over the tick that follows
    force = kStiffness * (contact.at(at(i)) - at(i));
  }
  EXPECT_NEAR(work_J / (-2 * std::numbers::pi * kStiffness * lag_m * std::sqrt(r * r - lag_m * lag_m)), 1, 6e-4);
}

// A hand that stretches the spring puts in just what it holds: with the mean of both ends' forces, to rounding.
TEST(Friction, TheSpringHoldsWhatTheHandPutIn) {
  Friction friction({1e9, 1e9, 0}, kStiffness, kRate);  // sticks for good
  PlaneContact contact(friction);
  double put_in_J = 0;
  Vec3 last_hip, last_t;
  bool first = true;
  for (Vec3 hip : wander(2000)) {
    hip.z() = std::min(hip.z(), -0.1e-3);
    const Vec3 t = contact.plane_T.nearest(hip) - contact.at(hip);
    if (!first) put_in_J += kStiffness * 0.5 * (t + last_t).dot(hip - last_hip);
    const double depth_m = -hip.z();
    ASSERT_NEAR(put_in_J, kStiffness * (contact.push.energy_m2 - 0.5 * depth_m * depth_m), 1e-15);
    first = false;
    last_hip = hip;
    last_t = t;
  }
  EXPECT_GT(put_in_J, 1e-4);
}

// Nothing that a tool does on the plane gives it energy: over any closed way the work is negative.
TEST(Friction, GivesNoEnergyOverAWanderingLoop) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    Friction friction({kStatic, kDynamic, 0.5}, kStiffness, kRate);
    PlaneContact contact(friction);
    std::vector<Vec3> way = wander(500, seed);
    for (Vec3& hip : way) hip.z() = -kDepth;
    way.push_back(way.front());
    double work_J = 0;
    for (std::size_t i = 0; i + 1 < way.size(); ++i) {
      // The mean of both ends' forces: what a spring does over the step, without the sampling's own energy.
      const Vec3 before = kStiffness * (contact.at(way[i]) - way[i]);
      const Vec3 after = kStiffness * (contact.at(way[i + 1]) - way[i + 1]);
      work_J += 0.5 * (before + after).dot(way[i + 1] - way[i]);
    }
    EXPECT_LT(work_J, 0) << seed;
  }
}

// A new plane turned about an edge through the sled: the stretch of the spring is laid along it, and gets no longer.
TEST(Friction, ANewPlaneNeverAddsToTheStretch) {
  for (const double angle : {-1.2, -0.5, 0.1, 0.5, 1.2}) {
    Friction friction = dry();
    PlaneContact contact(friction);
    contact.at({0, 0, -kDepth});
    const Vec3 hip(0.5 * kStatic * kDepth, 0, -kDepth);
    const double before_m = aside(contact.at(hip) - hip);
    ASSERT_NEAR(before_m, 0.5 * kStatic * kDepth, kRounding_m);
    const ContactPlane turned{Vec3::Zero(), Vec3(std::sin(angle), 0, std::cos(angle)), 0};
    contact.renew(turned);
    const Vec3 vhip = contact.at(hip);
    const Vec3 target = turned.nearest(hip);
    EXPECT_NEAR(turned.depth(vhip), 0, kRounding_m);
    ASSERT_GT(turned.depth(hip), 0);
    const double laid_m = std::min(before_m * std::cos(angle), kStatic * turned.depth(hip));
    EXPECT_LE((vhip - target).norm(), laid_m + kRounding_m);
  }
}

TEST(Friction, WithoutDepthThereIsNone) {
  Friction friction = dry();
  PlaneContact contact(friction);
  contact.at({0, 0, -kDepth});
  contact.at({0.1e-3, 0, -kDepth});
  EXPECT_EQ(contact.at({0.2e-3, 0, 0}), Vec3(0.2e-3, 0, 0));
}

TEST(Friction, ANewContactBeginsWithoutStretch) {
  Friction friction = dry();
  PlaneContact contact(friction);
  contact.at({0, 0, -kDepth});
  for (int i = 0; i < 100; ++i) contact.at({i * 1e-5, 0, -kDepth});
  contact.leave();
  EXPECT_EQ(contact.at({5e-3, 0, -kDepth}), Vec3(5e-3, 0, 0));
  // ... and sticks, though the last contact had ended slipping.
  EXPECT_EQ(contact.at({5e-3 + 0.99 * kStatic * kDepth, 0, -kDepth}).x(), 5e-3);
}

// A position that no tool can have reached: the sled is where the tool comes back to.
TEST(Friction, AWrongPositionPutsTheSledWhereTheToolIs) {
  for (const double wild : {0.11, 1e10, 1e200, HUGE_VAL, std::nan("")}) {
    Friction friction = dry();
    PlaneContact contact(friction);
    contact.at({0, 0, -kDepth});
    contact.at({0.1e-3, 0, -kDepth});
    contact.at({wild, 0, -kDepth});
    EXPECT_EQ(contact.at({0.1e-3, 0, -kDepth}), Vec3(0.1e-3, 0, 0)) << wild;
    EXPECT_NEAR(contact.at({0.1e-3 + 0.99 * kStatic * kDepth, 0, -kDepth}).x(), 0.1e-3, kRounding_m) << wild;
  }
}

// With K = 0 there is no force to limit; nothing divides by zero.
TEST(Friction, IsHarmlessWithoutStiffness) {
  for (const double viscous : {0.0, 1.0}) {
    Friction friction({kStatic, kDynamic, viscous}, 0, kRate);
    PlaneContact contact(friction);
    for (const Vec3& hip : wander(100)) ASSERT_TRUE(contact.at(hip).allFinite());
  }
}

}  // namespace friction_test
}  // namespace palpate
