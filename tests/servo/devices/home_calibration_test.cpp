// SPDX-License-Identifier: Apache-2.0
// A calibration that is led through random presses, glitches, motions, pushes, silences, lost orders and new
// connections, and held against the rules in its header, which are counted here from the events alone.
#include "servo/devices/home_calibration.hpp"

#include <algorithm>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "support/seeded.hpp"
#include "tests/support/long_run.hpp"

namespace palpate {
namespace home_calibration_test {

using State = HomeCalibration::State;
using Order = HomeCalibration::Order;
using Answer = HomeCalibration::Answer;

const Vec3 kReach_m(0.3, 0.2, 0.1), kHome(0, 0.4, -0.2);

double way_m(const Vec3& a, const Vec3& b) {
  return (a - b).cwiseAbs().dot(kReach_m);
}

// The arm at the other end: its button, what it was told, and what it has heard. It hears an order some reports later,
// or never.
class Arm {
 public:
  void press() { asks = true; }
  void tell(Order order, int delay) {
    if (order == Order::kNone) return;
    ++told_;
    waiting_ = {order, delay};
  }
  // A report: true if it counts from home since the one before.
  bool pass() {
    if (!waiting_ || waiting_->second-- > 0) return false;
    const Order order = std::exchange(waiting_, std::nullopt)->first;
    heard = told_;
    asks = false;
    return order == Order::kCountFromHome;
  }
  void reconnect() { waiting_.reset(); }

  bool asks = false;
  std::uint64_t heard = 0;

 private:
  std::uint64_t told_ = 0;
  std::optional<std::pair<Order, int>> waiting_;
};

// What was reported of the last moments.
struct Moments {
  struct Report {
    double time_s;
    Vec3 angles;
  };
  std::deque<Report> reports;
  double begun_s = 0;  // since when the counts go on without a break
  double pushed_s = -1;

  void add(double time_s, const Vec3& angles, bool is_elsewhere) {
    if (is_elsewhere) {
      reports.clear();
      begun_s = time_s;
    }
    reports.push_back({time_s, angles});
    while (reports.size() > 2 && reports[1].time_s < time_s - 0.2) reports.pop_front();
  }
  // The longest way from a place of the last `last_s` to the newest one.
  [[nodiscard]] double wander_m(double last_s) const {
    double most_m = 0;
    for (const Report& report : reports) {
      if (report.time_s >= reports.back().time_s - last_s)
        most_m = std::max(most_m, way_m(report.angles, reports.back().angles));
    }
    return most_m;
  }
  // It may have been seen to rest without force: within 1 mm of one place for 0.1 s.
  [[nodiscard]] bool mayRest(double now_s) const {
    constexpr double kSlack_s = 1e-9;
    return now_s - pushed_s >= HomeCalibration::kRest_s - kSlack_s &&
           reports.back().time_s - begun_s >= HomeCalibration::kRest_s - kSlack_s &&
           wander_m(0.099) <= 2 * HomeCalibration::kRest_m + 1e-12;
  }
  // It surely was, also in a silence within the time.
  [[nodiscard]] bool surelyRests(double now_s) const {
    return now_s - pushed_s > 0.12 && reports.back().time_s - begun_s > 0.15 &&
           reports.front().time_s < reports.back().time_s - 0.15 && wander_m(1) <= 0.4 * HomeCalibration::kRest_m;
  }
};

class Walk {
 public:
  explicit Walk(unsigned seed) : random_(seed), calibration_(kReach_m, kHome, random_.pick(2) == 0) {
    was_calibrated_ = calibration_.isCalibrated();
  }

  void run(int ticks) {
    for (int tick = 0; tick < ticks && !testing::Test::HasFatalFailure(); ++tick) {
      time_s_ = 1e-3 * (tick + 1);
      move();
      handsDo();
      if (random_.pick(400) == 0) silent_until_s_ = time_s_ + random_.between(0.002, 0.2);
      if (time_s_ < silent_until_s_) continue;
      report();
    }
  }
  std::map<std::pair<State, State>, int> edges;
  int orders = 0, repeated = 0, calibrations = 0;

 private:
  // Rests with a tremor, or goes somewhere; home again and again.
  void move() {
    if (time_s_ >= phase_until_s_) {
      phase_until_s_ = time_s_ + random_.between(0.05, 0.5);
      moves_ = random_.pick(3) == 0;
      speed_ = random_.between(-2, 2) * random_.direction();
      if (!moves_ && random_.pick(2) == 0) at_ = kHome + 0.02 * random_.direction();
      tremor_ = random_.pick(3) == 0 ? 0.002 : 0.0003;  // some tremble too much
    }
    if (moves_) at_ += 1e-3 * speed_;
    if ((at_ - kHome).norm() > 1) at_ = kHome;
  }
  void handsDo() {
    if (random_.pick(300) == 0) push_N_ = random_.pick(2) == 0 ? 0 : random_.logBetween(0.01, 5);
    if (push_N_ > HomeCalibration::kPush_N) moments_.pushed_s = time_s_;
    calibration_.push(push_N_, time_s_);
    if (random_.pick(250) == 0) arm_.press();
    if (random_.pick(200) == 0) glitch_until_s_ = time_s_ + 1e-3 * random_.pick(9);
    if (random_.pick(700) == 0) {
      calibration_.forget();
      was_calibrated_ = false;
    }
    if (random_.pick(600) == 0) reconnect();
    if (random_.pick(500) == 0 && !moments_.reports.empty()) ask();
  }
  void reconnect() {
    arm_.reconnect();
    const bool was_away = random_.pick(2) == 0;
    const State before = calibration_.state();
    calibration_.beginAnew(was_away);
    ASSERT_EQ(calibration_.state(), State::kCounts);
    note(before);
    if (was_away) was_calibrated_ = false;
    ASSERT_EQ(calibration_.isCalibrated(), was_calibrated_);
    begins_ = true;
    line_ = false;  // whatever its button said before
  }
  void ask() {
    const State before = calibration_.state();
    const CalibrationRefusal why = calibration_.ask(time_s_);
    expectRight(why);
    if (why == CalibrationRefusal::kNone) {
      ASSERT_EQ(calibration_.state(), State::kCalibrating);
      give(Order::kCountFromHome);
    } else {
      ASSERT_EQ(calibration_.state(), before);
    }
    note(before);
    ASSERT_EQ(calibration_.isCalibrated(), was_calibrated_);
  }

  void report() {
    const bool counts_home = arm_.pass();
    const bool line = arm_.asks || time_s_ < glitch_until_s_;
    const bool is_home = counts_home || (random_.pick(3) == 0 && way_m(at_, kHome) < 0.01);
    State before = calibration_.state();
    const Answer answer = calibration_.answer(arm_.heard, line, is_home);
    note(before);
    const bool may_answer = arm_.heard >= order_ && !line;
    if (answer == Answer::kFromHome) {
      ASSERT_TRUE(may_answer && is_home);
      ASSERT_TRUE(before == State::kForgetting || before == State::kCalibrating);
      was_calibrated_ = was_calibrated_ || before == State::kCalibrating;
      calibrations += before == State::kCalibrating ? 1 : 0;
    } else if (before == State::kCountingOn) {
      ASSERT_EQ(calibration_.state(), may_answer ? State::kCounts : before);
    } else {
      ASSERT_EQ(calibration_.state(), before);
    }
    ASSERT_EQ(calibration_.isCalibrated(), was_calibrated_);
    if (answer == Answer::kTooEarly) return;  // it is not used

    const bool is_elsewhere = begins_ || answer == Answer::kFromHome || random_.pick(2000) == 0;
    const bool just_before = !begins_ && time_s_ - last_s_ <= HomeCalibration::kJustBefore_s;
    begins_ = false;
    last_s_ = time_s_;
    if (line && !line_) {
      line_since_s_ = time_s_;
      line_reports_ = 0;
      seen_free_ = just_before;
    }
    line_ = line;
    ++line_reports_;
    const bool is_possible = time_s_ >= impossible_until_s_;
    if (random_.pick(1500) == 0) impossible_until_s_ = time_s_ + 1e-3 * random_.pick(5);
    const Vec3 shown = at_ + tremor_ * random_.inCube(1);
    moments_.add(time_s_, shown, is_elsewhere);
    impossible_ = is_possible || !was_calibrated_ ? 0 : impossible_ + 1;
    if (impossible_ >= HomeCalibration::kImpossible) was_calibrated_ = false;

    before = calibration_.state();
    const Order order = calibration_.look({.time_s = time_s_,
                                           .angles = shown,
                                           .asks = line,
                                           .just_before = just_before,
                                           .is_elsewhere = is_elsewhere,
                                           .is_possible = is_possible},
                                          time_s_);
    judge(before, order);
    note(before);
  }

  // What a report made of the state, by what it said.
  void judge(State before, Order order) {
    const State after = calibration_.state();
    const bool was_held = line_ && line_reports_ >= DebouncedButton::kFewestReports &&
                          time_s_ - line_since_s_ >= DebouncedButton::kPressed_s - 1e-9;
    if (!line_) {
      ASSERT_EQ(order, Order::kNone);
      ASSERT_EQ(after, before == State::kRefused ? State::kCounts : before);
    } else if (order == Order::kCountOn) {
      ASSERT_EQ(after, State::kCountingOn);
      ASSERT_TRUE(before == State::kRefused || before == State::kCountingOn);
      ASSERT_TRUE(moments_.mayRest(time_s_));
    } else if (order == Order::kCountFromHome) {
      ASSERT_TRUE(was_held);
      if (after == State::kForgetting) {
        ASSERT_FALSE(seen_free_ && before != State::kForgetting);
      } else {
        ASSERT_EQ(after, State::kCalibrating);
        expectRight(CalibrationRefusal::kNone);
      }
    } else if (after != before) {
      ASSERT_EQ(after, State::kRefused);
      ASSERT_TRUE(was_held && seen_free_);
      ASSERT_NE(calibration_.refusal(time_s_), CalibrationRefusal::kNone);
      expectRight(calibration_.refusal(time_s_));
    }
    repeated += order != Order::kNone && after == before ? 1 : 0;
    give(order);
    ASSERT_EQ(calibration_.isCalibrated(), was_calibrated_);
  }
  // An order must be given; one to count from home takes the calibration away.
  void give(Order order) {
    if (order == Order::kNone) return;
    ++orders;
    if (order == Order::kCountFromHome) was_calibrated_ = false;
    order_ = arm_.heard + 1;
    arm_.tell(order, random_.pick(8) == 0 ? 1'000'000 : random_.pick(4));
  }
  // Before an order takes the calibration away.
  void expectRight(CalibrationRefusal why) {
    if (moments_.reports.empty()) return;
    const bool is_near = way_m(moments_.reports.back().angles, kHome) <= HomeCalibration::kAtHome_m;
    if (why == CalibrationRefusal::kNone) {
      ASSERT_TRUE(moments_.mayRest(time_s_));
      ASSERT_TRUE(is_near || !was_calibrated_);
    } else if (why == CalibrationRefusal::kContact) {
      ASSERT_LT(time_s_ - moments_.pushed_s, HomeCalibration::kRest_s);
    } else if (why == CalibrationRefusal::kMoving) {
      ASSERT_FALSE(moments_.surelyRests(time_s_));
    } else {
      ASSERT_TRUE(was_calibrated_ && !is_near);
    }
  }
  void note(State before) {
    if (calibration_.state() != before) ++edges[{before, calibration_.state()}];
  }

  Seeded random_;
  HomeCalibration calibration_;
  Arm arm_;
  Moments moments_;
  bool was_calibrated_ = false;  // what it must say
  double time_s_ = 0, last_s_ = 0;
  double phase_until_s_ = 0, silent_until_s_ = 0, glitch_until_s_ = 0, impossible_until_s_ = 0;
  bool moves_ = false, begins_ = true, line_ = false, seen_free_ = false;
  double line_since_s_ = 0, push_N_ = 0, tremor_ = 0;
  int line_reports_ = 0, impossible_ = 0;
  std::uint64_t order_ = 0;  // that the last order is, once it is heard
  Vec3 at_ = kHome, speed_ = Vec3::Zero();
};

TEST(HomeCalibration, KeepsItsRulesWhateverHappens) {
  std::map<std::pair<State, State>, int> edges;
  int orders = 0, repeated = 0, calibrations = 0;
  for (unsigned seed = 0; seed < (isLongRun() ? 400U : 40U); ++seed) {
    SCOPED_TRACE(seed);
    Walk walk(seed);
    walk.run(20'000);
    if (HasFatalFailure()) return;
    for (const auto& [edge, times] : walk.edges) edges[edge] += times;
    orders += walk.orders;
    repeated += walk.repeated;
    calibrations += walk.calibrations;
  }
  // The table of the header: each of its lines was gone, and nothing else.
  std::set<std::pair<State, State>> table = {{State::kRefused, State::kCountingOn}};
  for (const State from :
       {State::kCounts, State::kRefused, State::kForgetting, State::kCalibrating, State::kCountingOn}) {
    for (const State to : {State::kForgetting, State::kCalibrating, State::kRefused, State::kCounts})
      if (from != to) table.insert({from, to});
  }
  for (const auto& [edge, times] : edges)
    EXPECT_TRUE(table.contains(edge)) << static_cast<int>(edge.first) << " to " << static_cast<int>(edge.second);
  for (const std::pair<State, State>& edge :
       {std::pair(State::kCounts, State::kForgetting), std::pair(State::kCounts, State::kCalibrating),
        std::pair(State::kCounts, State::kRefused), std::pair(State::kRefused, State::kCountingOn),
        std::pair(State::kRefused, State::kCounts), std::pair(State::kForgetting, State::kCounts),
        std::pair(State::kCalibrating, State::kCounts), std::pair(State::kCountingOn, State::kCounts)})
    EXPECT_GT(edges[edge], 10) << static_cast<int>(edge.first) << " to " << static_cast<int>(edge.second);
  EXPECT_GT(orders, 500);
  EXPECT_GT(repeated, 10);
  EXPECT_GT(calibrations, 50);
}

// An arm at rest at home, with a report each millisecond.
struct Resting {
  explicit Resting(bool is_calibrated = false) : calibration(kReach_m, kHome, is_calibrated) {
    static_cast<void>(calibration.look({.time_s = time_s, .angles = kHome, .is_elsewhere = true}, time_s));
    pass(200, false);
  }
  // The first order within so many reports.
  Order pass(int reports, bool asks, std::uint64_t heard = 0) {
    for (int i = 0; i < reports; ++i) {
      time_s += 1e-3;
      static_cast<void>(calibration.answer(heard, asks, false));
      const Order order =
          calibration.look({.time_s = time_s, .angles = kHome, .asks = asks, .just_before = true}, time_s);
      if (order == Order::kNone) continue;
      passed = i + 1;
      return order;
    }
    return Order::kNone;
  }
  double time_s = 0;
  int passed = 0;
  HomeCalibration calibration;
};

// The arm goes on asking: the order is lost, and given again after 100 reports.
TEST(HomeCalibration, GivesAnOrderAgainThatIsNotHeard) {
  Resting arm;
  EXPECT_EQ(arm.pass(20, true), Order::kCountFromHome);
  EXPECT_EQ(arm.passed, 11);  // the line has said it for 10 ms
  for (int again = 0; again < 3; ++again) {
    EXPECT_EQ(arm.pass(200, true), Order::kCountFromHome);
    EXPECT_EQ(arm.passed, HomeCalibration::kAskAgain);
    EXPECT_EQ(arm.calibration.state(), State::kCalibrating);
  }
  EXPECT_EQ(arm.calibration.answer(1, false, true), Answer::kFromHome);
  EXPECT_TRUE(arm.calibration.isCalibrated());
  EXPECT_EQ(arm.calibration.calibrations(), 1U);
}

// It has pushed 50 ms ago: refused. 100 ms after the push it is told to count on, and nothing has changed.
TEST(HomeCalibration, CountsOnAfterARefusal) {
  Resting arm(true);
  arm.calibration.push(1, arm.time_s);
  EXPECT_EQ(arm.pass(50, true), Order::kNone);
  EXPECT_EQ(arm.calibration.state(), State::kRefused);
  EXPECT_EQ(arm.calibration.refusal(arm.time_s), CalibrationRefusal::kContact);
  EXPECT_EQ(arm.calibration.refusals(0), 1U);
  EXPECT_EQ(arm.pass(60, true), Order::kCountOn);
  EXPECT_EQ(arm.passed, 50);
  EXPECT_TRUE(arm.calibration.isCalibrated());
  EXPECT_EQ(arm.calibration.answer(1, false, true), Answer::kNone);
  EXPECT_EQ(arm.calibration.state(), State::kCounts);
  EXPECT_EQ(arm.pass(2000, false, 1), Order::kNone);
  EXPECT_EQ(arm.calibration.refusal(arm.time_s), CalibrationRefusal::kNone);  // told for two seconds
}

// What looks like an answer but may have been sent before the order is not used, and calibrates nothing.
TEST(HomeCalibration, BelievesNoAnswerOfBefore) {
  Resting arm;
  ASSERT_EQ(arm.calibration.ask(arm.time_s), CalibrationRefusal::kNone);
  EXPECT_EQ(arm.calibration.answer(0, false, true), Answer::kTooEarly);
  EXPECT_FALSE(arm.calibration.isCalibrated());
  EXPECT_EQ(arm.calibration.answer(1, false, false), Answer::kNone);  // heard, but not at home yet
  EXPECT_EQ(arm.calibration.answer(1, false, true), Answer::kFromHome);
  EXPECT_TRUE(arm.calibration.isCalibrated());
}

// Another connection: what was told over the one before is not answered any more.
TEST(HomeCalibration, ForgetsItsOrdersWithTheConnection) {
  Resting arm;
  ASSERT_EQ(arm.calibration.ask(arm.time_s), CalibrationRefusal::kNone);
  arm.calibration.beginAnew(true);
  EXPECT_EQ(arm.calibration.state(), State::kCounts);
  EXPECT_EQ(arm.calibration.answer(5, false, true), Answer::kNone);
  EXPECT_FALSE(arm.calibration.isCalibrated());
}

}  // namespace home_calibration_test
}  // namespace palpate
