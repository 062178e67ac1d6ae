// SPDX-License-Identifier: Apache-2.0
// Swings against a surface, made by hand: each condition of the verdict "unstable" on both sides of its bound.
//
// A tool goes up and down along one line. 21 turns make 20 swings; the first turn after a beginning is none, since it
// may be where the tool began, and a turn is seen a tick later.
#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "servo/loop/contact_stability.hpp"
#include "servo/loop/swing_watch.hpp"
#include "servo/safety/faults.hpp"
#include "wanted_path.hpp"

namespace palpate {
namespace stability_swings_test {

const Vec3 kUp(0.48, 0.6, 0.64);
const Vec3 kAside(0.8, 0, -0.6);

// Heights over a surface through the origin, a millisecond a tick; below it there is contact.
class Tool {
 public:
  explicit Tool(double height_m, double given_J = 1e-6) : height_m_(height_m), given_J_(given_J) { note(); }

  void to(double height_m, int ticks = 5) {
    const double from_m = height_m_;
    for (int i = 1; i <= ticks; ++i) {
      height_m_ = i == ticks ? height_m : from_m + (height_m - from_m) * i / ticks;
      note();
    }
  }
  // Up and down by turns, up first.
  void swing(int count, double top_m, double bottom_m, int ticks = 5) {
    for (int i = 0; i < count; ++i) to(i % 2 == 0 ? top_m : bottom_m, ticks);
  }
  // So many swings of 1 mm within the object, and the tick that shows the last turn.
  static Tool inside(int count = 22, double given_J = 1e-6) {
    Tool tool(-2e-3, given_J);
    tool.swing(count, -1e-3, -2e-3);
    tool.to(-1.8e-3, 1);
    return tool;
  }
  // The same across the surface, 2 mm high.
  static Tool across(int count = 22) {
    Tool tool(-1e-3);
    tool.swing(count, 1e-3, -1e-3);
    tool.to(-0.6e-3, 1);
    return tool;
  }

  // Moves the surface to `height_m`, and the VHIP to `put_on_m` above it, in each tick of contact.
  using ByTick = std::function<double(int tick)>;
  void lay(const ByTick& height_m, const ByTick& put_on_m) {
    for (std::size_t i = 0; i < records.size(); ++i) {
      if (records[i].in_contact) lay(records[i], height_m(static_cast<int>(i)), put_on_m(static_cast<int>(i)));
    }
  }

  std::vector<TickRecord> records;

 private:
  static void copy(const Vec3& from, double (&to)[3]) { std::copy(from.begin(), from.end(), to); }
  void note() {
    TickRecord record;
    record.tick = static_cast<std::int64_t>(records.size());
    record.time_s = static_cast<double>(record.tick) / 1000;
    record.energy_J = -given_J_ * static_cast<double>(record.tick);
    copy(height_m_ * kUp, record.hip_W);
    copy(height_m_ * kUp, record.vhip_W);
    record.in_contact = height_m_ < 0;
    if (record.in_contact) {
      copy(kUp, record.normal_W);
      copy(kUp, record.force_W);
      lay(record, 0, 0);
    }
    records.push_back(record);
  }
  static void lay(TickRecord& record, double height_m, double put_on_m) {
    record.depth_m = height_m - kUp.dot(asVec3(record.hip_W));
    copy(asVec3(record.hip_W) + (record.depth_m + put_on_m) * kUp, record.vhip_W);
  }

  double height_m_, given_J_;
};

// The hand wants the tool at this height.
ContactStability assess(const Tool& tool, const std::function<double(double)>& path_m, double resolution_m = 0) {
  const WantedPath path([&](double time_s) { return Vec3(path_m(time_s) * kUp); });
  return assessContact(tool.records, {.resolution_m = resolution_m, .path = &path});
}
ContactStability assess(const Tool& tool) {
  return assess(tool, [](double) { return -1.5e-3; });
}
bool unstable(const ContactStability& s) {
  return s.verdict == ContactVerdict::kUnstable;
}

TEST(StabilitySwings, TwentyOfThemAreEnough) {
  Tool tool = Tool::inside();
  const ContactStability s = assess(tool);
  EXPECT_EQ(s.verdict, ContactVerdict::kUnstable);
  EXPECT_DOUBLE_EQ(s.unstable_from_s, 0.010);  // the second turn
  EXPECT_DOUBLE_EQ(s.unstable_to_s, 0.110);
  EXPECT_NEAR(s.swing_m, 1e-3, 1e-12);
  EXPECT_NEAR(s.swing_hz, 100, 1e-9);
  EXPECT_EQ(s.bounces, 0);
  tool.records.pop_back();  // the last turn is not seen
  const ContactStability before = assess(tool);
  EXPECT_EQ(before.verdict, ContactVerdict::kSlightlyActive);
  EXPECT_EQ(before.unstable_from_s, -1);
  EXPECT_EQ(before.unstable_to_s, -1);
  EXPECT_EQ(before.swing_m, 0);
}

// 20 swings of 1 mm, 20 of 2 mm half as fast, and 24 of 1 mm: the highest are told of, from the first turn to the last.
TEST(StabilitySwings, TheHighestAreToldOf) {
  Tool tool(-3e-3);
  tool.swing(22, -2e-3, -3e-3);
  tool.swing(20, -1e-3, -3e-3, 10);
  tool.swing(24, -2e-3, -3e-3);
  tool.to(-2.8e-3, 1);
  const ContactStability s = assess(tool);
  EXPECT_DOUBLE_EQ(s.unstable_from_s, 0.010);
  EXPECT_DOUBLE_EQ(s.unstable_to_s, 0.430);
  EXPECT_NEAR(s.swing_m, 2e-3, 1e-12);
  EXPECT_NEAR(s.swing_hz, 50, 1e-9);
}

TEST(StabilitySwings, ThatDieAwayAreNone) {
  static_assert(SwingWatch::kSustained == 0.75);
  for (const double later_m : {0.74e-3, 0.76e-3}) {
    Tool tool(-2e-3);
    tool.swing(12, -1e-3, -2e-3);
    tool.swing(10, -2e-3 + later_m, -2e-3);
    tool.to(-1.9e-3, 1);
    EXPECT_EQ(unstable(assess(tool)), later_m > 0.75e-3) << later_m;
  }
}

TEST(StabilitySwings, MustBeFedByTheSurface) {
  // 100 ticks against 1e-12 J, which is rounding.
  for (const double given_J : {-1e-6, 0.0, 0.8e-14, 1.2e-14})
    EXPECT_EQ(unstable(assess(Tool::inside(22, given_J))), given_J > 1e-14) << given_J;
}

// 20 mm of swings are more than ten times the 1.9 mm that the path asks for, and less than ten times 2.1 mm. Of the
// surface it is a quarter of that.
TEST(StabilitySwings, ThatAreAskedForAreNone) {
  static_assert(SwingWatch::kUnasked == 10 && SwingWatch::kAnswered == 40);
  const Tool still = Tool::inside();
  const auto none = [](int) { return 0.0; };
  for (const double asked_m : {1.9e-3, 2.1e-3}) {
    SCOPED_TRACE(asked_m);
    const double m_per_s = asked_m / 0.1;
    EXPECT_EQ(unstable(assess(still, [&](double t_s) { return -1.5e-3 - m_per_s * t_s; })), asked_m < 2e-3);
    Tool rising = still;
    rising.lay([&](int tick) { return m_per_s / 4 * tick * 1e-3; }, none);
    EXPECT_EQ(unstable(assess(rising)), asked_m < 2e-3);
    Tool falling = still;
    falling.lay([&](int tick) { return 2.5e-3 - m_per_s / 4 * tick * 1e-3; }, none);
    EXPECT_EQ(unstable(assess(falling)), asked_m < 2e-3);
  }
  // Aside a path may go as it likes.
  const WantedPath aside([](double t_s) { return Vec3(-1.5e-3 * kUp + t_s * kAside); });
  EXPECT_TRUE(unstable(assessContact(still.records, {.path = &aside})));
}

// What an effect adds to and fro in 100 ticks, 0.38 or some 0.73 mm, asks for swings; what it adds in proportion to the
// depth does not, however much that is.
TEST(StabilitySwings, AnEffectAsksUnlessItIsAStiffness) {
  const auto level = [](int) { return 0.0; };
  for (const double step_m : {0.00375e-3, 0.0075e-3}) {
    Tool shaken = Tool::inside();
    shaken.lay(level, [&](int tick) { return tick % 2 == 0 ? step_m / 2 : -step_m / 2; });
    EXPECT_EQ(unstable(assess(shaken)), step_m < 0.005e-3) << step_m;
  }
  Tool stiffer = Tool::inside();
  stiffer.lay(level, [&](int tick) { return 0.5 * stiffer.records[static_cast<std::size_t>(tick)].depth_m; });
  EXPECT_TRUE(unstable(assess(stiffer)));
}

// Twenty swings of 40 ms are 12.5 Hz, of 43 ms 11.6 Hz: a hand of which nothing is known can make these.
TEST(StabilitySwings, SlowOnesMayBeAHandsWhoseWayIsNotKnown) {
  static_assert(SwingWatch::kHand_hz == 12);
  for (const int ticks : {40, 43}) {
    Tool tool(-2e-3);
    tool.swing(22, -1e-3, -2e-3, ticks);
    tool.to(-1.9e-3, 1);
    EXPECT_EQ(unstable(assessContact(tool.records, {})), ticks == 40) << ticks;
    EXPECT_TRUE(unstable(assess(tool))) << ticks;
  }
}

// ---- bounces ----

// The surface shakes by 0.2 mm a tick in contact, 8 mm in all, and asks for more than a tenth of the 40 mm. But the
// tool left it in each period, while the hand wanted it inside.
Tool bouncing() {
  Tool tool = Tool::across();
  tool.lay([](int tick) { return tick % 2 == 0 ? 0.1e-3 : -0.1e-3; }, [](int) { return 0.0; });
  return tool;
}

TEST(StabilitySwings, BouncesAreEnoughWhateverTheSurfaceAsks) {
  const ContactStability s = assess(bouncing());
  EXPECT_TRUE(unstable(s));
  EXPECT_EQ(s.bounces, 11);
  EXPECT_NEAR(s.swing_m, 2e-3, 1e-12);
  const ContactStability wanted = assess(bouncing(), [](double) { return 1.5e-3; });
  EXPECT_FALSE(unstable(wanted));
  EXPECT_EQ(wanted.bounces, 0);
}

TEST(StabilitySwings, NineBouncesInTenPeriodsAreTooFew) {
  const auto path = [](double t_s) { return std::abs(t_s - 0.053) < 1e-4 ? 0.3e-3 : -0.05e-3; };
  const ContactStability s = assess(bouncing(), path);
  EXPECT_EQ(s.bounces, 10);
  EXPECT_FALSE(unstable(s));
  EXPECT_TRUE(unstable(assess(bouncing(), [](double) { return -0.05e-3; })));
}

TEST(StabilitySwings, BouncesThatThePathAsksForAreNone) {
  for (const double asked_m : {3.9e-3, 4.1e-3})
    EXPECT_EQ(unstable(assess(bouncing(), [&](double t_s) { return -1.5e-3 - asked_m / 0.1 * t_s; })), asked_m < 4e-3);
}

// The hand wants the tool inside if that is by more than two steps of the encoders.
TEST(StabilitySwings, ABounceIsOutwardsAndUnwanted) {
  Tool tool(-1e-3);
  tool.to(1e-3);
  for (const double path_m : {-25e-6, -15e-6})
    EXPECT_EQ(assess(
                  tool, [&](double) { return path_m; }, 10e-6)
                  .bounces,
              path_m < -20e-6 ? 1 : 0);
  Tool lost(-1e-3);
  lost.to(-2e-3);
  lost.records.back().in_contact = false;  // no surface is there any more
  EXPECT_EQ(assess(lost).bounces, 0);
}

// ---- what starts the count anew ----

// In the 60th tick, a turn: the next turn is none, and the one after it, in the 70th, is the first.
TEST(StabilitySwings, AFaultOrASurfaceThatEndsStartsTheCountAnew) {
  const auto spoilt = [](Tool tool, bool ended) {
    TickRecord& record = tool.records[60];
    if (ended) {
      record.in_contact = false;
    } else {
      record.faults = bit(ServoFault::kNoWindow);
    }
    return tool;
  };
  for (const bool ended : {false, true}) {
    SCOPED_TRACE(ended);
    EXPECT_FALSE(unstable(assess(spoilt(Tool::inside(33), ended))));
    const ContactStability s = assess(spoilt(Tool::inside(34), ended));
    EXPECT_TRUE(unstable(s));
    EXPECT_DOUBLE_EQ(s.unstable_from_s, 0.070);
    EXPECT_DOUBLE_EQ(s.unstable_to_s, 0.170);
  }
  Tool noted = Tool::inside();
  noted.records[60].faults = bit(ServoFault::kForceLimited);
  EXPECT_TRUE(unstable(assess(noted)));
}

TEST(StabilitySwings, ALongFlightStartsTheCountAnew) {
  static_assert(SwingWatch::kLongestFlight_s == 0.5);
  for (const int hover_ticks : {400, 600}) {
    Tool tool(-1e-3);
    tool.swing(11, 1e-3, -1e-3);
    tool.to(1e-3, hover_ticks);
    tool.to(-1e-3);
    tool.swing(10, 1e-3, -1e-3);
    tool.to(-0.6e-3, 1);
    const ContactStability s = assess(tool);
    EXPECT_EQ(unstable(s), hover_ticks == 400);
    EXPECT_EQ(s.bounces, 11);
  }
}

// 2 um where fingers feel less, two and a half steps of the encoders, and what a finger feels: here at 100 Hz, where
// that is 3.2 um, and at 250 Hz.
TEST(StabilitySwings, SmallOnesDoNotCount) {
  const auto of = [](double high_m, int ticks = 5) {
    Tool tool(-1e-3);
    tool.swing(24, -1e-3 + high_m, -1e-3, ticks);
    return tool;
  };
  const auto path = [](double) { return -1e-3; };
  EXPECT_FALSE(unstable(assess(of(1.9e-6, 2), path)));
  EXPECT_TRUE(unstable(assess(of(2.1e-6, 2), path)));
  EXPECT_FALSE(unstable(assess(of(2.9e-6), path)));
  EXPECT_TRUE(unstable(assess(of(3.4e-6), path)));
  EXPECT_FALSE(unstable(assess(of(20e-6), path, 9e-6)));
  EXPECT_TRUE(unstable(assess(of(20e-6), path, 7e-6)));
}

}  // namespace stability_swings_test
}  // namespace palpate
