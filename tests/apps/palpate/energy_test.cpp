// SPDX-License-Identifier: Apache-2.0
// The energy of a run as a user gets it: in the trace, in the summary, in words; and the controller that takes it back.
#include <cmath>

#include <nlohmann/json.hpp>

#include "program_test.hpp"
#include "trace.hpp"

namespace palpate {
namespace energy_test {

using Json = nlohmann::json;

class Energy : public ProgramTest {
 protected:
  Json touch(const Words& more) { return touched(quickTouch("phantom:sphere?size=24", more)); }
  Json touched(const Words& words_of_it) {
    const Outcome outcome = run(words_of_it);
    expectSuccess(outcome);
    words = outcome.out;
    return Json::parse(contentsOf(file("out/summary.json")));
  }
  std::string words;
};

// The force of a row, held until the next, times the way from there to here.
TEST_F(Energy, OfTheTraceIsTheWorkOfItsForces) {
  const Json summary = touch({});
  const Trace trace = readTrace(file("out/trace.csv"));
  double taken_J = 0, least_J = 0, sum_J = 0;
  for (std::size_t i = 1; i < trace.rows.size(); ++i) {
    const double work_J = trace.rows[i - 1].force_N().dot(trace.rows[i].hip_W() - trace.rows[i - 1].hip_W());
    taken_J -= work_J;
    least_J = std::min(least_J, taken_J);
    sum_J += std::abs(work_J);
    ASSERT_NEAR(trace.rows[i].energy_J(), taken_J, 1e-13 * sum_J) << i;  // 300 sums, each to 2e-16 of the largest
  }
  EXPECT_GT(sum_J, 0);
  EXPECT_NEAR(summary["energy"]["end_J"].get<double>(), taken_J, 1e-13 * sum_J);
  EXPECT_NEAR(summary["energy"]["min_J"].get<double>(), least_J, 1e-13 * sum_J);
  EXPECT_THAT(words, testing::HasSubstr("\nEnergy    "));
}

// A contact without damping, felt three ticks late: K T (1/2 + 3) = 5.25 N s/m of damping too little against 3 of the
// hand's and the device's: it gives energy away.
TEST_F(Energy, TheControllerTakesItBack) {
  const Words active = {"--hand", "spring", "--stiffness", "1500", "--damping", "0", "--delay", "3"};
  const Json observed = touch(active);
  EXPECT_GT(observed["energy"]["active_ticks"], 0);
  EXPECT_EQ(observed["energy"]["damped_ticks"], 0);
  EXPECT_THAT(words, testing::HasSubstr("Energy    slightly active: "));
  EXPECT_EQ(observed["stability"]["verdict"], "slightly-active");
  EXPECT_EQ(observed["stability"]["source"], "sampled-wall");
  EXPECT_GT(observed["stability"]["given_J"], 0);
  const Json controlled = touch(active + Words{"--passivity", "control"});
  EXPECT_GT(controlled["energy"]["damped_ticks"], 0);
  EXPECT_GT(controlled["energy"]["min_J"], observed["energy"]["min_J"]);
  EXPECT_THAT(words, testing::HasSubstr("the controller acted in"));
}

// Encoders of 10 um under a rigid hand that comes back: what they make of the energy is within what they may.
TEST_F(Energy, EncodersMakeNoEnergy) {
  const Json summary = touch({"--encoder", "0.01"});
  EXPECT_EQ(summary["stability"]["verdict"], "quiet");
  EXPECT_LE(summary["stability"]["given_J"].get<double>(), summary["stability"]["allowed_J"].get<double>());
  EXPECT_GE(summary["energy"]["end_J"].get<double>(), -summary["stability"]["allowed_J"].get<double>());
  EXPECT_THAT(words, testing::Not(testing::HasSubstr("took -")));
}

// K T / 2 = 5 N s/m against 3.1 of hand and device: it bounces, and that is said where everybody looks.
TEST_F(Energy, ABouncingRunIsCalledUnstable) {
  const Words bouncing = {"touch",       "phantom:sphere?size=24",
                          "--seconds",   "3",
                          "--clock",     "simulated",
                          "--picture",   "off",
                          "--out",       "out",
                          "--hand",      "spring",
                          "--shaking",   "leave",
                          "--stiffness", "10000"};
  const Json summary = touched(bouncing);
  EXPECT_EQ(summary["stability"]["ended_by_servo"], 0);
  EXPECT_EQ(summary["stability"]["verdict"], "unstable");
  EXPECT_GT(summary["stability"]["bounces"], 10);
  EXPECT_GT(summary["stability"]["swing_m"], 20e-6);
  EXPECT_THAT(summary["verdict"].get<std::string>(), testing::HasSubstr("the contact was unstable: lower --stiffness"));
  EXPECT_THAT(words, testing::HasSubstr("Energy    unstable: "));
  // The same stiffness, half of it by an effect: the surface, its depth and the verdict are the same.
  Words half = bouncing;
  half.back() = "5000";
  const Json by_effect = touched(half + Words{"--stiffness-density", "0:2"});
  EXPECT_EQ(by_effect["stability"]["verdict"], "unstable");
  EXPECT_NEAR(by_effect["contact"]["depth_m"]["max"].get<double>(), summary["contact"]["depth_m"]["max"].get<double>(),
              0.05e-3);
  Words guarded = bouncing;
  guarded[guarded.size() - 3] = "end";
  const Json ended = touched(guarded);
  EXPECT_EQ(ended["stability"]["verdict"], "unstable");
  EXPECT_EQ(ended["stability"]["ended_by_servo"], 1);
  EXPECT_THAT(words, testing::HasSubstr("the servo took the force away 1 time"));
  const Json fast = touched(bouncing + Words{"--rate", "20000"});
  EXPECT_NE(fast["stability"]["verdict"], "unstable");
  EXPECT_TRUE(fast["stability"]["swing_m"].is_null());
}

}  // namespace energy_test
}  // namespace palpate
