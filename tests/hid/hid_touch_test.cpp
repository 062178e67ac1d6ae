// SPDX-License-Identifier: Apache-2.0
// `palpate touch` with an emulated Polhem through hidapi, in lockstep: what is felt is what the simulated device feels.
#include <algorithm>

#include "emulated_program.hpp"

namespace palpate {
namespace hid_touch_test {

using testing::HasSubstr;

// Of Polhem v1 in the middle of its workspace (arm_kinematics.hpp): one count of its encoders at most.
constexpr double kResolution_m = 6.1e-5;

struct Difference {
  double position_m = 0, force_N = 0, largest_N = 0;
  std::size_t ticks = 0, contact_ticks = 0;
};

class HidTouch : public EmulatedHid {
 protected:
  // While the force of a device that a person holds grows from nothing it cannot feel as a simulated one does.
  static constexpr double kRest_s = 1.1;

  // The same way, with the simulated device and with the emulated Polhem.
  Difference compare(const std::string& volume, const Vec3& at_mm, const Words& more) const {
    const Words common = Words{"--clock", "simulated", "--picture", "off", "--force-limit", "5"} + more;
    const std::string at = fmt::format("{},{},{}", at_mm.x(), at_mm.y(), at_mm.z());
    const std::string at_m = fmt::format("{},{},{}", 1e-3 * at_mm.x(), 1e-3 * at_mm.y(), 1e-3 * at_mm.z());
    const Outcome simulated =
        run(Words{"touch", volume, "--path", "way.csv", "--hand", "spring", "--out", "simulated"} + common);
    EXPECT_EQ(simulated.status, 0) << simulated.err;
    const Trace exact = readTrace(file("simulated") / "trace.csv");
    const Outcome real = on({"--path", "way.csv", "--at", at_m},
                            Words{"touch", volume, "--device", "polhem-v1", "--place-at", at, "--place-scale", "1",
                                  "--calibrated", "--current-limit", "3", "--edge", "0", "--seconds",
                                  fmt::format("{:.3f}", 1e-3 * static_cast<double>(exact.rows.size()))} +
                                common);
    EXPECT_EQ(real.status, 0) << real.err;
    const Trace felt = readTrace(file("out") / "trace.csv");
    EXPECT_EQ(exact.rows.size(), felt.rows.size());
    Difference d{.ticks = std::min(exact.rows.size(), felt.rows.size())};
    for (std::size_t i = 0; i < d.ticks; ++i) {
      d.position_m = std::max(d.position_m, (exact.rows[i].hip_W() - felt.rows[i].hip_W()).norm());
      d.force_N = std::max(d.force_N, (exact.rows[i].force_N() - felt.rows[i].force_N()).norm());
      d.largest_N = std::max(d.largest_N, felt.rows[i].force_N().norm());
      d.contact_ticks += felt.rows[i].inContact() ? 1 : 0;
    }
    return d;
  }
};

// Positions differ by the rounding of three encoders, half a count each, which the closed loop may double. So forces
// differ by K times that, and by the damping of a velocity that is off by a count in the filter's time, 1 / (2 pi 200).
TEST_F(HidTouch, FeelsASphereAsTheSimulatedDeviceDoes) {
  constexpr double kStiffness = 400, kDamping = 0.5;
  writeWay("phantom:sphere?size=64", 2, 2, 1, kRest_s);
  const Difference d = compare("phantom:sphere?size=64", Vec3::Zero(), {"--stiffness", "400"});
  EXPECT_GE(d.ticks, 1999U);  // the way's rows are as many as its last time has ticks
  EXPECT_GT(d.contact_ticks, 1000U);
  EXPECT_GT(d.largest_N, 0.3);
  EXPECT_LE(d.position_m, kResolution_m);
  EXPECT_LE(d.force_N, kStiffness * kResolution_m + kDamping * 2 * std::acos(-1.0) * 200 * kResolution_m);
  EXPECT_GT(d.position_m, 0.01 * kResolution_m);  // the encoders do round
  EXPECT_EQ(figure("reports_written"), static_cast<double>(d.ticks - 1));
  for (const char* none : {"reports_lost", "reports_garbled", "reports_implausible", "writes_refused", "disconnects"})
    EXPECT_EQ(figure(none), 0) << none;
  EXPECT_EQ(summary()["device"]["force_off"], "none");
  EXPECT_THAT(summary()["libraries"].dump(), HasSubstr("libhidapi-hidraw"));
}

// The surface gives way under the tool, so that a difference would grow: over the whole run it stays a few counts.
TEST_F(HidTouch, DrillsAScanAsTheSimulatedDeviceDoes) {
  const auto scans = realScans();
  const auto head = std::ranges::find_if(scans, [](const auto& p) { return p.filename() == "ct_head_headsq.nrrd"; });
  if (head == scans.end()) GTEST_SKIP() << "no scans: PALPATE_DATA names their folder";
  writeWay(head->string(), 1, 1, 1, kRest_s);
  const Vec3 start_mm = 1e3 * readTrace(file("rigid") / "trace.csv").rows.front().hip_W();
  const Difference d = compare(head->string(), start_mm, {"--stiffness", "400", "--edit", "remove:radius=2mm:rate=20"});
  EXPECT_GT(d.contact_ticks, 200U);
  EXPECT_LE(d.position_m, 2 * kResolution_m);
  EXPECT_GT(summary()["edits"]["count"].get<int>(), 10);
}

TEST_F(HidTouch, IsTheSameBitForBit) {
  const Words touch = {"touch",
                       "phantom:sphere?size=32",
                       "--device",
                       "polhem-v1",
                       "--place-scale",
                       "1",
                       "--calibrated",
                       "--current-limit",
                       "3",
                       "--seconds",
                       "0.5",
                       "--clock",
                       "simulated",
                       "--picture",
                       "off"};
  EXPECT_EQ(on({}, touch + Words{"--out", "one"}).status, 0);
  EXPECT_EQ(on({}, touch + Words{"--out", "two"}).status, 0);
  EXPECT_EQ(contentsOf(file("one") / "trace.csv"), contentsOf(file("two") / "trace.csv"));
}

// What was recorded of a session feels the same without the device, bit for bit, as often as one likes.
TEST_F(HidTouch, IsPlayedBackBitForBit) {
  writeWay("phantom:sphere?size=32", 1, 1);
  const Words common = {"--clock", "simulated", "--picture", "off", "--stiffness", "400"};
  const Words touch = {"touch", "phantom:sphere?size=32"};
  const Outcome session =
      on({"--path", "way.csv", "--at", "0,0,0", "--faults", "0.01"},
         touch + kArmInTheMiddle + Words{"--seconds", "1", "--record", "s.rec", "--out", "session"} + common);
  ASSERT_EQ(session.status, 0) << session.err;
  for (const char* out : {"one", "two"}) {
    const Outcome again = run(touch + Words{"--device", "recorded", "--recording", "s.rec", "--out", out} + common);
    ASSERT_EQ(again.status, 0) << again.err;
    EXPECT_EQ(contentsOf(file(out) / "trace.csv"), contentsOf(file("session") / "trace.csv"));
  }
  EXPECT_LT(std::filesystem::file_size(file("s.rec")), 1000U * 40U);
}

// In real time the link's thread keeps the reports flowing; nothing here depends on how fast.
TEST_F(HidTouch, TouchesInRealTime) {
  const Outcome outcome = on({}, {"touch", "phantom:sphere?size=32", "--device", "polhem-v1", "--calibrated",
                                  "--current-limit", "3", "--seconds", "0.5", "--picture", "off"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_GT(figure("reports_received"), 10);
  EXPECT_GE(figure("reports_written"), figure("reports_received") - 1);
  EXPECT_THAT(summary()["work"]["threads"].dump(), HasSubstr("\"device\""));
  EXPECT_GT(figure("write_max_us"), 0);
}

// A scene that asks for no stiffness gets no more than the maker states and the device can render; who asks for more is
// told the bound.
TEST_F(HidTouch, TakesTheStiffnessThatTheDeviceBears) {
  const Words touch = {"touch",
                       "phantom:sphere?size=16",
                       "--device",
                       "polhem-v1",
                       "--clock",
                       "simulated",
                       "--seconds",
                       "0.1",
                       "--picture",
                       "off",
                       "--calibrated",
                       "--current-limit",
                       "3"};
  const Words unscaled = touch + Words{"--place-scale", "1"};
  EXPECT_EQ(on({}, unscaled).status, 0);
  const double usual = summary()["scene"]["servo"]["stiffness_N_per_m"];
  EXPECT_GT(usual, 500);  // its own, not everybody's
  EXPECT_LE(usual, 800);
  const Outcome stiff = on({}, unscaled + Words{"--stiffness", "5000"});
  EXPECT_EQ(stiff.status, 0);
  EXPECT_EQ(summary()["scene"]["servo"]["stiffness_N_per_m"], 5000);
  EXPECT_THAT(stiff.err, HasSubstr("is more than the device's maker states: give at most 800 N/m"));
  EXPECT_THAT(stiff.err, HasSubstr("a wall of 5000 N/m is one of 5000 N/m at its handle"));
  const Outcome scaled = on({}, touch + Words{"--stiffness", "500", "--place-scale", "2", "--force-scale", "0.5"});
  EXPECT_THAT(
      scaled.err,
      HasSubstr(
          "1 mm of the device moves the tool by 2 mm, 1 N of the scene is 0.5 N; a wall of 500 N/m is one of 500 N/m"));
}

// ---- why there is no force ----

TEST_F(HidTouch, SaysWhyThereIsNoDevice) {
  const Words touch = {"touch", "phantom:sphere?size=16", "--device", "polhem-v1", "--clock", "simulated"};
  expectRefusal(on({"--devices", "none"}, touch), "device polhem-v1", "no HID device is there at all", 3);
  expectRefusal(on({"--devices", "keyboard"}, touch), "device polhem-v1", "there are only 046d:c31c", 3);
  expectRefusal(on({"--devices", "gadget"}, touch), "device polhem-v1", "is another thing: its usage is ff00:0001", 3);
  expectRefusal(on({"--devices", "polhem,teensy"}, touch), "device polhem-v1", "there are two", 2);
  expectRefusal(on({"--devices", "keyboard"}, touch + Words{"--device-path", "/dev/hidraw0"}), "/dev/hidraw0",
                "the device there is no polhem-v1", 2);
  EXPECT_EQ(
      on({"--devices", "polhem,teensy"}, touch + Words{"--device-path", "/dev/hidraw1", "--seconds", "0.1"}).status, 0);
}

// Something else lies where a device should: it is not written to, nor by a servo's broker, which is asked for it.
TEST_F(HidTouch, OpensNothingElse) {
  const Words touch = {"touch", "phantom:sphere?size=16", "--device", "polhem-v1", "--clock", "simulated"};
  for (const Words& more : {Words{}, Words{"--service"}})
    expectRefusal(on({"--devices", "impostor"}, touch + more), "/dev/hidraw0", "what lies there is no device of hidraw",
                  2);
}

// Whoever did not check the motors feels less than 1 N, and is told so; the same hand feels more with them checked.
TEST_F(HidTouch, StaysBelowANewtonUntilTheMotorsAreChecked) {
  const std::string ball = "phantom:sphere?size=32";
  writeWay(ball, 1.5, 6);  // a held device has all its force after a second
  const auto largest_N = [&](bool checked) {
    motors_checked_ = checked;
    std::filesystem::remove_all(file("state"));
    const Outcome outcome =
        on({"--path", "way.csv", "--log", "log.txt"}, Words{"touch", ball, "--clock", "simulated", "--picture", "off",
                                                            "--seconds", "1.5", "--stiffness", "500", "--out", "out"} +
                                                          kArmInTheMiddle);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    const std::string told = "nobody has checked that its motors pull the right way, so forces stay below 1 N";
    const bool is_told = outcome.err.find(told) != std::string::npos;
    EXPECT_EQ(is_told, !checked) << outcome.err;
    const std::string log = contentsOf(file("log.txt")), key = " force_max_N ";
    return std::stod(log.substr(log.find(key) + key.size()));
  };
  const double unchecked_N = largest_N(false);
  EXPECT_GT(unchecked_N, 0.02);
  EXPECT_LE(unchecked_N, 1);
  EXPECT_GT(largest_N(true), 1);
}

TEST_F(HidTouch, SaysWhyTheForcesAreOff) {
  const Words touch = {"touch",     "phantom:sphere?size=16",
                       "--device",  "polhem-v1",
                       "--clock",   "simulated",
                       "--seconds", "0.1",
                       "--picture", "off"};
  const Outcome no_limit = on({}, touch + Words{"--calibrated"});
  EXPECT_EQ(no_limit.status, 0);
  EXPECT_THAT(no_limit.err, HasSubstr("forces are off because nobody said what current"));
  EXPECT_EQ(summary()["device"]["force_off"], "no-current-limit");
  const Outcome uncalibrated = on({"--uncalibrated"}, touch + Words{"--current-limit", "3"});
  EXPECT_THAT(uncalibrated.err, HasSubstr("forces are off because the device does not know where its handle is"));
  EXPECT_EQ(summary()["device"]["force_off"], "uncalibrated");
  Words longer = touch + Words{"--current-limit", "3"};
  *std::ranges::find(longer, "0.1") = "0.4";  // its handle must have been seen at rest
  const Outcome asked = on({"--uncalibrated", "--asks-from", "200"}, longer);
  EXPECT_EQ(asked.status, 0);
  EXPECT_EQ(figure("calibrations"), 1);
  EXPECT_EQ(summary()["device"]["force_off"], "none");
  // A calibrated arm says that its handle is in the middle of the workspace, which is not its home.
  const Outcome refused = on({"--asks-from", "200"}, longer + Words{"--calibrated"});
  EXPECT_EQ(refused.status, 0);
  EXPECT_EQ(figure("calibrations"), 0);
  EXPECT_EQ(figure("calibrations_refused_in_contact") + figure("calibrations_refused_away"), 1);
  EXPECT_EQ(summary()["device"]["force_off"], "none");
  EXPECT_THAT(summary()["faults"].dump(), HasSubstr("calibration-refused"));
  // Pressed before anybody looked: where the handle was then nobody knows.
  const Outcome long_ago = on({"--asks-from", "0"}, touch + Words{"--current-limit", "3", "--calibrated"});
  EXPECT_EQ(long_ago.status, 0);
  EXPECT_EQ(figure("calibrations"), 0);
  EXPECT_EQ(summary()["device"]["force_off"], "uncalibrated");
}

}  // namespace hid_touch_test
}  // namespace palpate
