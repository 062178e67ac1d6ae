// SPDX-License-Identifier: Apache-2.0
// Trouble on the way between an emulated Polhem and the program: lost, garbled, short, double and late answers, a cable
// that is pulled and plugged in again, a device that never answers.
#include "emulated_program.hpp"

namespace palpate {
namespace hid_faults_test {

using testing::HasSubstr;

struct Account {
  double reports = 0, force_max_N = 0, force_rise_max_N = 0, faults = 0, left_400ms_N = 0, left_600ms_N = 0, silent = 0,
         extra = 0, spoiled = 0, force_later_N = 0;
};

class HidFaults : public EmulatedHid {
 protected:
  [[nodiscard]] Account account(const std::string& name = "log") const {
    std::istringstream in(contentsOf(file(name)));
    Account a;
    std::string word;
    in >> word >> word >> a.reports >> word >> a.force_max_N >> word >> a.force_rise_max_N >> word >> a.faults >>
        word >> a.left_400ms_N >> word >> a.left_600ms_N >> word >> a.silent >> word >> a.extra >> word >> a.spoiled >>
        word >> a.force_later_N;
    return a;
  }
  static Words pressing(const std::string& seconds) {
    return Words{"touch", "phantom:sphere?size=64"} + kArmInTheMiddle +
           Words{"--stiffness", "400", "--clock", "simulated", "--picture", "off", "--seconds", seconds};
  }
};

// The force never changes by more than the slew limit allows in a tick, here 0.2 N, and what the motors round (half a
// milliampere of each: 0.02 N), and each of the faults is in the summary. An answer that comes while the program still
// reads the one before is of the next exchange, which hides one that is lost: now and then.
TEST_F(HidFaults, KeepTheForceSafe) {
  writeWay("phantom:sphere?size=64", 4, 2);
  const Outcome outcome = on({"--path", "way.csv", "--at", "0,0,0", "--faults", "0.05", "--log", "log"},
                             pressing("4") + Words{"--slew-limit", "200", "--force-limit", "0.5"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Account a = account();
  EXPECT_GT(a.faults, 100);
  EXPECT_GT(a.force_max_N, 0.4);  // the limit is reached
  EXPECT_LE(a.force_max_N, 0.52);
  EXPECT_LE(a.force_rise_max_N, 0.22);
  EXPECT_NEAR(figure("reports_lost"), a.silent, 2 + 0.05 * a.silent);
  EXPECT_NEAR(figure("reports_superseded"), a.extra, 2 + 0.05 * a.extra);
  // One in a hundred garbled answers looks like one that is right.
  EXPECT_NEAR(figure("reports_garbled") + figure("reports_implausible"), a.spoiled, 2 + 0.05 * a.spoiled);
}

// The switch of the handle is the clutch: no force while it is pressed, the tool stays where it is, and the force comes
// back from nothing.
TEST_F(HidFaults, TheClutchTakesTheForceAway) {
  writeWay("phantom:sphere?size=64", 2, 2);
  const Outcome outcome =
      on({"--path", "way.csv", "--at", "0,0,0", "--press", "900:1100", "--log", "log"}, pressing("2"));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(summary()["faults"].dump(), HasSubstr("force-off"));
  const Trace trace = readTrace(file("out") / "trace.csv");
  EXPECT_GT(trace.rows[890].force_N().norm(), 0.1);
  for (std::size_t i = 905; i < 1095; ++i) {
    ASSERT_EQ(trace.rows[i].force_N().norm(), 0) << i;
    ASSERT_LT((trace.rows[i].hip_W() - trace.rows[905].hip_W()).norm(), 1e-12) << i;
  }
  EXPECT_GT(trace.rows[1250].force_N().norm(), 0.05);  // the hand has moved meanwhile
  for (std::size_t i = 1095; i < 1250; ++i)            // it took a tenth of a second
    ASSERT_LT((trace.rows[i + 1].force_N() - trace.rows[i].force_N()).norm(), 0.1) << i;
}

TEST_F(HidFaults, AreToldWhenTheCableIsPulled) {
  writeWay("phantom:sphere?size=64", 2, 2);
  const Outcome outcome =
      on({"--path", "way.csv", "--at", "0,0,0", "--unplug-after", "1000", "--log", "log"}, pressing("2"));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(summary()["device"]["force_off"], "disconnected");
  EXPECT_EQ(figure("disconnects"), 1);
  EXPECT_THAT(summary()["faults"].dump(), HasSubstr("device-error"));
  const Trace trace = readTrace(file("out") / "trace.csv");
  EXPECT_GT(trace.rows[900].force_N().norm(), 0.1);
  for (std::size_t i = 1200; i < trace.rows.size(); ++i) EXPECT_EQ(trace.rows[i].force_N().norm(), 0) << i;
}

// It comes back by itself, and counts from anywhere: no force until it is calibrated again, whatever was said at the
// start. By the real clock, since it comes back after a time.
TEST_F(HidFaults, ACableThatIsPluggedInAgainBringsTheDeviceBackWithoutForce) {
  writeWay("phantom:sphere?size=64", 4, 2);
  const Outcome outcome = on(
      {"--paced", "--path", "way.csv", "--at", "0,0,0", "--unplug-after", "1000", "--replug-ms", "200", "--log", "log"},
      Words{"touch", "phantom:sphere?size=64"} + kArmInTheMiddle +
          Words{"--edge", "0", "--seconds", "4", "--picture", "off"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(summary()["device"]["force_off"], "uncalibrated");
  EXPECT_EQ(figure("disconnects"), 1);
  EXPECT_EQ(figure("reconnects"), 1);
  EXPECT_GT(figure("reports_received"), 1100);  // it answers again
  EXPECT_GT(account().force_max_N, 0.1);        // before
  EXPECT_EQ(account().force_later_N, 0);        // as the arm took it
  EXPECT_THAT(outcome.out, HasSubstr("force-off"));
  const Trace trace = readTrace(file("out") / "trace.csv");
  ASSERT_GT(trace.rows.size(), 3000U);
  for (std::size_t i = trace.rows.size() - 1000; i < trace.rows.size(); ++i)
    EXPECT_EQ(trace.rows[i].force_N().norm(), 0) << i;
}

// A device that answers no more in contact: its last position grows old, which is a fault, and the force fades.
TEST_F(HidFaults, AreToldWhenTheDeviceFallsSilent) {
  writeWay("phantom:sphere?size=64", 2, 2);
  const Outcome outcome =
      on({"--path", "way.csv", "--at", "0,0,0", "--silent-after", "900", "--log", "log"}, pressing("1.1"));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_GE(figure("reports_lost"), 150);
  EXPECT_THAT(summary()["faults"].dump(), HasSubstr("dropped-reports"));
  const Trace trace = readTrace(file("out") / "trace.csv");
  EXPECT_GT(trace.rows[890].force_N().norm(), 0.1);
  EXPECT_EQ(trace.rows.back().force_N().norm(), 0);
}

// The program is killed while it presses: what protects the hand then is the arm's own watchdog, half a second later.
TEST_F(HidFaults, AKilledProgramLeavesTheForceToTheWatchdog) {
  writeWay("phantom:sphere?size=64", 2, 2, 0.5);  // ends in contact
  Words touch = pressing("60");
  touch[std::ranges::find(touch, "simulated") - touch.begin()] = "real";
  const Outcome outcome = emulate({"--path", "way.csv", "--at", "0,0,0", "--paced", "--log", "log"},
                                  Words{"timeout", "-s", "KILL", "3", PALPATE_PROGRAM} + touch);
  EXPECT_NE(outcome.status, 0);
  const Account a = account();
  EXPECT_GT(a.left_400ms_N, 0.05);
  EXPECT_EQ(a.left_600ms_N, 0);
}

// With the servo in a process of its own it is the engine that is killed: the servo brings the force to zero itself,
// long before the watchdog would. The shell lives on, so that the arm is still served.
TEST_F(HidFaults, AKilledEngineLeavesNoForce) {
  writeWay("phantom:sphere?size=64", 2, 2, 0.5);
  std::string touch = std::string("timeout -s KILL 3 ") + PALPATE_PROGRAM;
  for (const std::string& word : pressing("60"))
    touch += " '" + (word == "simulated" ? std::string("real") : word) + "'";
  const Outcome outcome = emulate({"--path", "way.csv", "--at", "0,0,0", "--paced", "--log", "log"},
                                  {"sh", "-c", touch + " --service; sleep 1"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const Account a = account();
  EXPECT_GT(a.force_max_N, 0.05);
  EXPECT_EQ(a.left_400ms_N, 0);
}

// The same tick by tick, through hidapi in the other process.
TEST_F(HidFaults, AreTheSameWithTheServoInAProcessOfItsOwn) {
  writeWay("phantom:sphere?size=64", 1, 2);
  const Words machine = {"--path", "way.csv", "--at", "0,0,0"};
  ASSERT_EQ(on(machine, pressing("1") + Words{"--out", "one"}).status, 0);
  const Outcome outcome = on(machine, pressing("1") + Words{"--out", "two", "--service"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(contentsOf(file("one") / "trace.csv") == contentsOf(file("two") / "trace.csv"));
  EXPECT_EQ(summary("one")["device"]["force_off"], summary("two")["device"]["force_off"]);
  for (const char* count : {"reports_written", "reports_received", "reports_lost", "calibrations"})
    EXPECT_EQ(figure(count, "one"), figure(count, "two")) << count;
}

}  // namespace hid_faults_test
}  // namespace palpate
