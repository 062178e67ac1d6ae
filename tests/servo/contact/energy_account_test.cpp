// SPDX-License-Identifier: Apache-2.0
#include "servo/contact/energy_account.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "contact/plane_contact.hpp"

namespace palpate {
namespace energy_account_test {

// The plane z = 0, and what effects are said to want there.
class Account {
 public:
  Vec3 at(const Vec3& hip, const Vec3& d, double energy_m2, double stiffness = 1) {
    ContactState contact;
    contact.hip_W = hip;
    contact.plane = {Vec3::Zero(), Vec3::UnitZ(), 0};
    contact.new_contact = first_;
    const Vec3 out =
        account_.settle(contact, {.vhip_W = hip + d, .energy_m2 = energy_m2, .stiffness = stiffness}) - hip;
    if (!first_) given_m2_ += 0.5 * (out + last_d_).dot(hip - last_hip_);
    first_ = false;
    last_hip_ = hip;
    last_d_ = out;
    largest_m2_ = std::max(largest_m2_, energy_m2);
    return out;
  }
  // The plane's own push, times `factor` of its stiffness, that says so or not.
  Vec3 press(const Vec3& hip, double factor = 1, double said = 1) {
    return at(hip, Vec3(0, 0, -factor * hip.z()), 0.5 * factor * hip.z() * hip.z(), said);
  }
  [[nodiscard]] double given() const { return given_m2_; }
  [[nodiscard]] double largest() const { return largest_m2_; }

 private:
  EnergyAccount account_;
  bool first_ = true;
  Vec3 last_hip_, last_d_;
  double given_m2_ = 0, largest_m2_ = 0;
};

constexpr double kDepth = 1e-3;
constexpr int kTicks = 200;

double depthAt(int i) {
  return -kDepth * i / kTicks;
}

TEST(EnergyAccount, WhatHasAPotentialIsLeftAsItIs) {
  Account account;
  for (const Vec3& hip : wander(5000)) {
    const Vec3 d(0, 0, -hip.z());
    ASSERT_NEAR((account.at(hip, d, 0.5 * hip.z() * hip.z()) - d).norm(), 0, 1e-17);
  }
}

// Positions that no tool can have reached, in between: afterwards all is as it was, and nothing is a broken number. In
// the first tick after them what there is counts as put in.
TEST(EnergyAccount, AWrongPositionLeavesNothingBehind) {
  for (const double wild : {0.11, 1e10, 1e200, HUGE_VAL, std::nan("")}) {
    Account account;
    for (const Vec3& hip : wander(100)) account.press(hip);
    for (int i = 0; i < 3; ++i) account.at(Vec3(wild, 0, -wild), Vec3(0, 0, wild), 0.5 * wild * wild);
    for (const Vec3& hip : wander(1000, 2)) {
      const Vec3 d(0, 0, -hip.z());
      ASSERT_NEAR((account.press(hip) - d).norm(), 0, 1e-17) << wild;
    }
  }
}

// Pressed in where it is soft, drawn out where it is four times as hard: the force is that of the soft place, to what
// is free, and the hand gets back what it gave, to what is free.
TEST(EnergyAccount, AStiffnessThatNobodyPaidForIsNotThere) {
  Account account;
  for (int i = 0; i <= kTicks; ++i) account.press({0, 0, depthAt(i)});
  for (int i = kTicks; i >= 0; --i) {
    const double strength = account.press({1e-6, 0, depthAt(i)}, 4).z() / (4 * -depthAt(i) + 1e-30);
    if (i > 0) {
      ASSERT_NEAR(strength, 0.25, 0.25 * 0.02) << i;
    }
  }
  EXPECT_LE(account.given(), EnergyAccount::kFree * account.largest() * 1.01);
}

// A drive along the way, with nothing stored for it, is cancelled by the drag; over a long way nothing is given.
TEST(EnergyAccount, ADriveAlongTheWayIsCancelled) {
  Account account;
  for (int i = 0; i <= kTicks; ++i) account.press({0, 0, depthAt(i)});
  const double drive_m = 0.05 * kDepth;
  Vec3 d;
  for (int i = 1; i <= 2000; ++i) {
    d = account.at({i * 20e-6, 0, -kDepth}, Vec3(drive_m, 0, kDepth), 0.5 * kDepth * kDepth);
  }
  EXPECT_NEAR(d.x(), 0, 0.02 * drive_m);
  // A way of D pays kRepayments debts, and the drive is drive D over it: debt = drive D / kRepayments.
  const double debt = drive_m / kDepth / EnergyAccount::kRepayments / 0.5;
  EXPECT_NEAR(d.z() / kDepth, 1 - (debt - EnergyAccount::kFree), 0.2 * debt);
}

// Friction's work is credit: with it nothing is weakened.
TEST(EnergyAccount, WhatFrictionTookPaysForIt) {
  Account account;
  for (int i = 0; i <= kTicks; ++i) account.press({0, 0, depthAt(i)});
  Vec3 d;
  const double drive_m = 0.05 * kDepth;
  for (int i = 1; i <= 2000; ++i) {
    d = account.at({i * 20e-6, 0, -kDepth}, Vec3(drive_m - 0.1 * kDepth, 0, kDepth), 0.5 * kDepth * kDepth);
  }
  EXPECT_NEAR((d - Vec3(-drive_m, 0, kDepth)).norm(), 0, 1e-17);
}

// A plane that jumps up by itself gives energy that is its own: it is not charged, whatever the stiffness there.
TEST(EnergyAccount, WhatThePlaneGaveIsNotCharged) {
  for (const double factor : {1.0, 5.0}) {
    EnergyAccount account;
    Vec3 d;
    for (int i = 1; i <= 400; ++i) {
      ContactState contact;
      contact.hip_W = Vec3(0, 0, -kDepth);
      contact.plane = {Vec3(0, 0, i < 100 ? 0.0 : 0.2e-3), Vec3::UnitZ(), 0};
      contact.new_contact = i == 1;
      const double depth_m = contact.plane.depth(contact.hip_W);
      d = account.settle(contact, {.vhip_W = contact.hip_W + Vec3(0, 0, factor * depth_m),
                                   .energy_m2 = 0.5 * factor * depth_m * depth_m,
                                   .stiffness = factor}) -
          contact.hip_W;
    }
    EXPECT_NEAR(d.z(), factor * 1.2e-3, 1e-9);
  }
}

// A contact that begins exactly on the surface, with nothing stored, is as strong as any: rounding alone decides
// whether the hand's work is above or below what is stored then.
TEST(EnergyAccount, AContactThatBeginsOnTheSurfaceIsWhole) {
  for (const double first_m : {0.0, 1e-19, 1e-12}) {
    for (const double step_m : {0.1e-3, 0.0317e-3, 1e-6}) {
      Account account;
      for (int i = 0; i < 40; ++i) {
        const Vec3 hip(0, 0, -first_m - i * step_m);
        ASSERT_NEAR(account.press(hip).z(), -hip.z(), 1e-12) << first_m << " " << step_m << " " << i;
      }
      // What stores a tenth more than the first step's work, as a steep bump does, neither owes nor gives it.
      Account bump;
      for (int i = 0; i < 40; ++i) {
        const Vec3 hip(0, 0, -first_m - i * step_m);
        const double energy_m2 = 0.5 * hip.z() * hip.z() + (i > 0 ? 0.05 * step_m * step_m : 0);
        ASSERT_NEAR(bump.at(hip, Vec3(0, 0, -hip.z()), energy_m2).z(), -hip.z(), 0.01 * -hip.z() + 1e-12)
            << first_m << " " << step_m << " " << i;
      }
    }
  }
}

TEST(EnergyAccount, ANewContactOwesNothing) {
  Account account;
  for (int i = 0; i <= kTicks; ++i) account.press({0, 0, depthAt(i)});
  ASSERT_LT(account.press({0, 0, -kDepth}, 4).z(), 2 * kDepth);
  Account next;
  EXPECT_NEAR(next.press({0, 0, -kDepth}, 4).z(), 4 * kDepth, 1e-17);
}

// Whatever is wanted, d is finite, never longer than what was wanted and its drag, and what is given stays within what
// is free.
TEST(EnergyAccount, HoldsForAnythingThatEffectsWant) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    Account account;
    double longest_m = 0;
    const std::vector<Vec3> way = wander(3000, seed), wish = wander(3000, seed + 100);
    for (std::size_t i = 0; i < way.size(); ++i) {
      const Vec3 hip(way[i].x(), way[i].y(), i == 0 ? -1e-6 : std::min(way[i].z(), -1e-6));
      Vec3 wanted(std::sin(1e3 * wish[i].x()) * 2e-3, std::sin(1e3 * wish[i].y()) * 2e-3, -wish[i].z());
      if (i == 0) wanted = -hip.z() * Vec3::UnitZ();
      const double energy_m2 = 0.5 * wanted.z() * wanted.z();
      const Vec3 d = account.at(hip, wanted, energy_m2);
      ASSERT_TRUE(d.allFinite());
      ASSERT_LE(d.norm(), wanted.norm() + EnergyAccount::kMostDrag * 2e-3);
      // What the force of one tick does on the way to the next, half of it by the trapezoid, is seen too late.
      ASSERT_LE(account.given(), EnergyAccount::kFree * account.largest() + 0.5 * longest_m * 0.2e-3 * std::sqrt(3.0));
      longest_m = std::max(longest_m, d.norm());
    }
  }
}

}  // namespace energy_account_test
}  // namespace palpate
