// SPDX-License-Identifier: Apache-2.0
// The judge must see what is wrong: runs that are made up, each with one flaw.
#include "apps/extreme/judge.hpp"

#include <limits>

#include <gmock/gmock.h>

#include "apps/extreme/ground.hpp"
#include "base/error.hpp"

namespace palpate {
namespace judge_test {

using testing::HasSubstr;

// Twenty ticks in contact with the plane z = 0, 1 mm deep, with 0.5 N from K = 500 N/m.
struct Made {
  RoughRun run;
  RoughResult result;
  Made() {
    run.parameters.stiffness_N_per_m = 500;
    result.force_limit_N = 8;
    result.slew_per_tick_N = 4;
    result.referee = {.forces = 20, .largest_N = 0.5, .largest_change_N = 0.5};
    for (int tick = 0; tick < 20; ++tick) {
      TickRecord record;
      record.tick = tick;
      record.hip_W[2] = -1e-3;
      record.normal_W[2] = 1;
      record.force_W[2] = 0.5;
      record.in_contact = true;
      result.records.push_back(record);
    }
  }
  [[nodiscard]] Judge judge() const { return Judge(run, result); }
};

constexpr double kAllowed_m = 1e-5;

void expectFlaw(const ExtremeOutcome& outcome, const std::string& words) {
  EXPECT_FALSE(outcome.as_expected);
  EXPECT_THAT(outcome.seen, HasSubstr(words));
}

TEST(Judge, FindsNothingWrongWithAGoodRun) {
  const Made made;
  const ExtremeOutcome outcome =
      made.judge().feels({}, kAllowed_m).isPushed(Vec3::UnitZ(), 0.5).raisesNoFadingFault().outcome("words");
  EXPECT_TRUE(outcome.as_expected) << outcome.seen;
  EXPECT_EQ(outcome.seen, "words; 0.5 N at most, contact in 20 of 20 ticks, faults: none");
}

TEST(Judge, SeesForcesBeyondTheirLimits) {
  Made made;
  made.result.referee.largest_N = 8.001;
  expectFlaw(made.judge().outcome(), "beyond the limit of 8 N");
  made = {};
  made.result.referee.largest_change_N = 4.001;
  expectFlaw(made.judge().outcome(), "beyond the slew of 4 N a tick");
  made = {};
  made.result.referee.not_finite = 1;
  expectFlaw(made.judge().outcome(), "1 forces are not finite");
}

TEST(Judge, SeesPlacesAndNormalsThatCannotBe) {
  Made made;
  made.result.records[7].vhip_W[1] = std::numeric_limits<double>::infinity();
  expectFlaw(made.judge().outcome(), "tick 7");
  made = {};
  made.result.records[8].normal_W[2] = 0.99;
  expectFlaw(made.judge().outcome(), "tick 8: a VHIP that is not finite, or a normal of length 0.99");
  made = {};
  made.result.records[9].normal_W[2] = 0;  // without contact there is none
  EXPECT_TRUE(made.judge().outcome().as_expected);
}

TEST(Judge, SeesAForceThatIsNotThePlanes) {
  Made made;
  made.result.records[19].force_W[2] = 0.5 + 500 * 1.01 * kAllowed_m;
  expectFlaw(made.judge().feels({}, kAllowed_m).outcome(), "tick 19: the force is off by 0.00505 N of 0.5 N");
  made = {};
  made.result.records[18].force_W[0] = 0.1;
  expectFlaw(made.judge().feels({}, kAllowed_m).outcome(), "tick 18");
  made = {};
  made.result.records[18].in_contact = false;
  expectFlaw(made.judge().feels({}, kAllowed_m).outcome(), "tick 18: no contact");
  made = {};
  made.result.records[17].in_contact = false;  // before the last tenth
  EXPECT_TRUE(made.judge().feels({}, kAllowed_m).outcome().as_expected);
}

TEST(Judge, SeesATooWeakAndASidewaysPush) {
  Made made;
  expectFlaw(made.judge().isPushed(Vec3::UnitZ(), 0.51).outcome(), "a force of 0.5 N");
  expectFlaw(made.judge().isPushed(Vec3::UnitX(), 0.1).outcome(), "0 N of it outward");
}

TEST(Judge, SeesForcesThatShouldNotBeThere) {
  const Made made;
  expectFlaw(made.judge().feelsNothing().outcome(), "there is a force of 0.5 N");
  expectFlaw(made.judge().endsWithoutForce().outcome(), "it ends with 0.5 N");
}

TEST(Judge, SeesFaultsThatAreMissingOrTooMany) {
  Made made;
  expectFlaw(made.judge().raises(ServoFault::kStall).outcome(), "stall is not told");
  made.result.records[3].faults = bit(ServoFault::kStall);
  EXPECT_TRUE(made.judge().raises(ServoFault::kStall).outcome().as_expected);
  expectFlaw(made.judge().raisesNoFadingFault().outcome(), "stall is told");
  made.result.records[3].faults = bit(ServoFault::kForceLimited);
  EXPECT_TRUE(made.judge().raisesNoFadingFault().outcome().as_expected);
}

TEST(Judge, SeesARunWithoutTicks) {
  Made made;
  made.result.records.clear();
  expectFlaw(made.judge().outcome(), "no tick was run");
}

TEST(RefusedWith, WantsTheWords) {
  const auto refusal = [] { throw Error(Error::Code::kBadInput, "x", "it is red", "paint it"); };
  EXPECT_TRUE(refusedWith("is red", refusal).as_expected);
  EXPECT_FALSE(refusedWith("is blue", refusal).as_expected);
  EXPECT_FALSE(refusedWith("is red", [] {}).as_expected);
}

TEST(OutcomeOf, AnErrorIsAnOutcome) {
  const ExtremeCase one{"g", "n", "e",
                        []() -> ExtremeOutcome { throw Error(Error::Code::kBadInput, "x", "it is red", "paint it"); }};
  expectFlaw(outcomeOf(one), "it was refused: x: it is red");
}

// A servo without the plane that it should feel: the whole chain of a case can fail.
TEST(FeelsGround, FailsOnAnotherPlane) {
  const Ground ground;
  RoughRun run = pressOn(ground.sampled(), ground);
  const RoughResult result = play(run);
  EXPECT_TRUE(Judge(run, result).feels(ground.plane, placeError_m(ground)).outcome().as_expected);
  ExactPlane higher = ground.plane;
  higher.p_W.z() += 1.01 * placeError_m(ground) + 0.04 * ground.voxel_m();
  EXPECT_FALSE(Judge(run, result).feels(higher, placeError_m(ground)).outcome().as_expected);
}

}  // namespace judge_test
}  // namespace palpate
