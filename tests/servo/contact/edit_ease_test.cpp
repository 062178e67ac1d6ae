// SPDX-License-Identifier: Apache-2.0
#include "servo/contact/edit_ease.hpp"

#include <gtest/gtest.h>

#include "support/seeded.hpp"

namespace palpate {
namespace edit_ease_test {

// One turn is gone in equal steps over kTime_s, to the last bit.
TEST(EditLead, DrainsInEqualSteps) {
  EditLead<double> lead(1000);
  EXPECT_FALSE(lead.active());
  EXPECT_EQ(lead.elapse(), 0);
  lead.take(-2);
  for (int tick = 1; tick < 500; ++tick) {
    ASSERT_NEAR(lead.elapse(), -2 * (1 - tick / 500.0), 1e-12) << tick;
    ASSERT_TRUE(lead.active());
  }
  // Rounding may leave the last step for another tick.
  lead.elapse();
  EXPECT_EQ(lead.elapse(), 0);
  EXPECT_FALSE(lead.active());
}

// Turns of any direction at random times, as under a brush: what is shown goes by no more in a tick than the largest
// lead that there was over kTime_s; and a later turn never slows the draining, so the lead is gone that long after the
// last one.
TEST(EditLead, IsGoneInTimeAfterTheLastOfManyEdits) {
  Seeded random(5);
  for (int trial = 0; trial < 100; ++trial) {
    EditLead<Vec3> lead(1000);
    Vec3 whole = Vec3::Zero(), last_shown = Vec3::Zero();
    double largest = 0, last_step = 0;
    const int edits = 1 + random.pick(20);
    for (int edit = 0; edit < edits; ++edit) {
      const Vec3 turn = random.inCube(1);
      whole += turn;
      lead.take(turn);
      largest = std::max(largest, (whole - last_shown).norm());
      const int ticks = edit + 1 == edits ? 502 : random.pick(200);
      for (int tick = 0; tick < ticks; ++tick) {
        const Vec3 before = whole - last_shown;
        const Vec3 shown = whole - lead.elapse();
        const double step = (shown - last_shown).norm();
        ASSERT_LE(step, largest / 500 + 1e-12) << trial << " " << edit << " " << tick;
        if (before.norm() > 2 * last_step) {
          ASSERT_GE(step, last_step - 1e-12) << trial << " " << edit << " " << tick;
        }
        last_step = step;
        last_shown = shown;
      }
    }
    EXPECT_EQ(last_shown, whole) << trial;
  }
}

TEST(EditLead, StaysWithinItsBound) {
  EditLead<double> lead(1000);
  lead.take(-3);
  lead.bound(4);
  EXPECT_NEAR(lead.elapse(), -3 + 3.0 / 500, 1e-12);
  lead.bound(1);
  EXPECT_NEAR(lead.elapse(), -1 + 3.0 / 500, 1e-12);  // as fast as before
  lead.bound(-1);
  EXPECT_FALSE(lead.active());
  EXPECT_EQ(lead.elapse(), 0);
}

TEST(EditLead, TakesNothingThatIsNotFinite) {
  EditLead<Vec3> lead(1000);
  lead.take(Vec3(0, std::nan(""), 0));
  EXPECT_FALSE(lead.active());
  EXPECT_EQ(lead.elapse(), Vec3::Zero());
}

TEST(EditLead, EndsAtOnce) {
  EditLead<Mat3> lead(1000);
  lead.take(Mat3::Identity());
  lead.end();
  EXPECT_FALSE(lead.active());
  EXPECT_EQ(lead.elapse(), Mat3::Zero());
}

}  // namespace edit_ease_test
}  // namespace palpate
