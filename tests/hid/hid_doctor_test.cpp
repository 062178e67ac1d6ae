// SPDX-License-Identifier: Apache-2.0
// `palpate doctor` and `palpate calibrate` on emulated devices: each reason for no force is named, and what helps.
#include <sstream>

#include <sys/stat.h>

#include "emulated_program.hpp"
#include "service/sandbox/call_filter.hpp"
#include "service/sandbox/file_fence.hpp"
#include "tests/support/long_run.hpp"

namespace palpate {
namespace hid_doctor_test {

using testing::HasSubstr;

class HidDoctor : public EmulatedHid {
 protected:
  [[nodiscard]] Outcome doctor(const Words& machine, const Words& more = {}) const {
    return on(machine, Words{"doctor", "--seconds", "0.3", "--json", "d.json"} + more);
  }
  [[nodiscard]] Json json() const { return Json::parse(contentsOf(file("d.json"))); }
  void expectOff(const Outcome& outcome, const std::string& why) const {
    EXPECT_EQ(outcome.status, 1) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("\nforces are off because " + why));
    EXPECT_THAT(json()["verdict"], HasSubstr(why));
    EXPECT_FALSE(json()["forces_on"]);
  }
};

TEST_F(HidDoctor, SaysThatForcesAreOn) {
  const Outcome outcome = doctor({}, {"--device", "polhem-v1", "--calibrated", "--current-limit", "3"});
  EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("\nforces are on: polhem-v1\n"));
  EXPECT_THAT(outcome.out, HasSubstr("polhem-v1 answers: 1234:0006 \"mbed Polhem\" at /dev/hidraw0"));
  EXPECT_TRUE(json()["forces_on"]);
  EXPECT_GT(json()["trial"]["device"]["reports_received"], 3);
  EXPECT_EQ(json()["trial"]["failed_share"], 0);
  EXPECT_EQ(json()["hid"][0]["usage"], "ffab:0200");
  const bool has_both = hasCallFilters() && landlockVersion() > 0;
  EXPECT_THAT(outcome.out, HasSubstr(has_both ? "a servo's own process gives up files and system calls"
                                              : "this kernel lets a servo's own process give up"));
}

TEST_F(HidDoctor, NamesEachReasonForNoForce) {
  const Words polhem = {"--device", "polhem-v1"};
  expectOff(doctor({"--devices", "none"}), "no haptic device is here; plug one in");
  expectOff(doctor({"--devices", "keyboard"}), "no haptic device is here");
  EXPECT_THAT(json()["findings"].dump(), HasSubstr("no haptic device that Palpate knows"));
  expectOff(doctor({"--devices", "none"}, polhem), "device polhem-v1: none of this machine's HID devices is one");
  expectOff(doctor({"--devices", "gadget"}, polhem),
            "device polhem-v1: 1234:0006 \"A lamp\" at /dev/hidraw0 has its USB numbers, but");
  expectOff(doctor({}), "its USB numbers do not say which arm it is");
  expectOff(doctor({}, polhem), "nobody said what current the device's firmware is made for");
  expectOff(doctor({"--uncalibrated"}, polhem + Words{"--current-limit", "3"}),
            "the device does not know where its handle is");
  expectOff(doctor({"--devices", "polhem,teensy"}, polhem), "device polhem-v1: there are two");
}

// Root may use anything, so the program runs as nobody.
TEST_F(HidDoctor, KnowsADeviceWithoutMotors) {
  const Outcome outcome = doctor({"--devices", "keyboard,spacemouse"});
  expectOff(outcome, "the device has no motors");
  EXPECT_EQ(json()["device"], "spacemouse");
  EXPECT_EQ(doctor({"--devices", "spacemouse,polhem"}, {"--calibrated"}).status, 1);
  EXPECT_EQ(json()["device"], "polhem-v1");  // one that can exert forces is meant
}

TEST_F(HidDoctor, NamesMissingRightsAndTheRuleThatGivesThem) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can become another user";
  std::filesystem::permissions(folder(), std::filesystem::perms::all);
  const Words as_nobody = {"setpriv", "--reuid=65534", "--clear-groups"};
  const Outcome outcome = emulate({"--forbidden"}, as_nobody + Words{PALPATE_PROGRAM, "doctor", "--seconds", "0.2",
                                                                     "--json", "d.json", "--device", "polhem-v1"});
  expectOff(outcome, "you have no right to use /dev/hidraw0; sudo palpate doctor --install-udev");
  EXPECT_THAT(outcome.out, HasSubstr("(its rule: KERNEL==\"hidraw*\", ATTRS{idVendor}==\"1234\", "
                                     "ATTRS{idProduct}==\"0006\", MODE=\"0660\", TAG+=\"uaccess\")"));
  EXPECT_THAT(outcome.out, HasSubstr("and you may not use it; sudo palpate doctor --install-udev"));
  EXPECT_THAT(outcome.out, HasSubstr("note  real time"));
  EXPECT_FALSE(json()["hid"][0]["may_use"]);
}

// Without a device, without rights, without real time: each command works, or says in one line what is missing.
TEST_F(HidDoctor, AnOrdinaryUserIsToldInOneLine) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can become another user";
  std::filesystem::permissions(folder(), std::filesystem::perms::all);
  struct Case {
    Words arguments;
    int status;
    std::string words;  // of the one line; empty: it works
  };
  const std::string phantom = "phantom:sphere?size=16";
  for (const Case& c : {Case{{"devices"}, 0, ""}, Case{{"faults"}, 0, ""}, Case{{"info", phantom}, 0, ""},
                        Case{{"touch", phantom, "--seconds", "0.2", "--picture", "off"}, 0, ""},
                        Case{{"plan", phantom, "--rounds", "0"}, 0, ""},
                        Case{{"touch", phantom, "--device", "polhem-v1"}, 6, "you have no right to use it"},
                        Case{{"touch", phantom, "--device", "spacemouse"}, 3, "none of this machine's HID devices"},
                        Case{{"touch", phantom, "--require-real-time"}, 6, "no real-time priority"},
                        Case{{"calibrate", "--device", "polhem-v1", "--yes"}, 6, "you have no right to use it"},
                        Case{{"doctor", "--install-udev"}, 4, "sudo palpate doctor --install-udev"}}) {
    const Outcome outcome =
        emulate({"--forbidden"}, Words{"setpriv", "--reuid=65534", "--clear-groups", PALPATE_PROGRAM} + c.arguments);
    EXPECT_EQ(outcome.status, c.status) << c.arguments[0] << "\n" << outcome.err;
    Words lines = errorLines(outcome.err);
    std::erase_if(lines, isBoundWarning);
    EXPECT_EQ(lines.size(), c.words.empty() ? 0U : 1U) << outcome.err;
    if (c.words.empty() || lines.empty()) continue;
    EXPECT_THAT(lines.front(), HasSubstr(c.words));
  }
}

// A table that allows no force.
// It began as a Polhem, and went on as something else.
TEST_F(HidDoctor, NamesReportsThatCannotBeUsed) {
  const Words polhem = {"--device", "polhem-v1", "--calibrated", "--current-limit", "3"};
  const Outcome outcome = doctor({"--paced", "--garbled-after", "40"}, polhem);
  expectOff(outcome, "most of the device's reports cannot be used; see that --device names what it is");
  EXPECT_THAT(outcome.out, HasSubstr("most of its reports cannot be used"));
  EXPECT_EQ(doctor({"--paced", "--faults", "0.3"}, polhem).status, 0);  // a bad cable is told, and is no reason
}

TEST_F(HidDoctor, NamesALimitOfZero) {
  std::filesystem::create_directories(file("palpate/devices"));
  write("palpate/devices/a.toml",
        "[[device]]\nname = \"weak\"\nfamily = \"polhem-family\"\nwhat = \"none\"\nusb = [{ id = \"1234:0006\", "
        "report_bytes = 14 }]\nvalues = { force_limit_N = 0 }\n");
  expectOff(doctor({}, {"--device", "weak", "--calibrated", "--current-limit", "3"}), "the force limit is 0");
}

// What is calibrated stays so while the device is plugged in.
TEST_F(HidDoctor, CalibratesForLaterRuns) {
  const std::string program = PALPATE_PROGRAM;
  const std::string doctor = program + " doctor --seconds 0.2 --device polhem-v1 --current-limit 3";
  const Outcome outcome = emulate(
      {"--uncalibrated"}, {"sh", "-c", doctor + "; " + program + " calibrate --device polhem-v1 --yes && " + doctor});
  EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("forces are off because the device does not know where its handle is"));
  EXPECT_THAT(outcome.out,
              HasSubstr("polhem-v1 counts from its home position until it is unplugged, the machine sleeps, or "));
  EXPECT_THAT(outcome.out, HasSubstr("forces are on: polhem-v1\n"));
}

// What a run leaves for the next one.
TEST_F(HidDoctor, KnowsAfterARunWhetherTheDeviceIsCalibrated) {
  const std::string program = PALPATE_PROGRAM;
  const std::string calibrate = program + " calibrate --device polhem-v1 --yes; ";
  const auto touch = [&](double seconds) {
    return fmt::format(
        "{} touch phantom:sphere?size=16 --device polhem-v1 --current-limit 3 --picture off --seconds {}", program,
        seconds);
  };
  const std::string doctor = "; " + program + " doctor --seconds 0.2 --device polhem-v1 --current-limit 3";
  const auto after = [&](const Words& machine, const std::string& commands) {
    return emulate(Words{"--paced"} + machine, {"sh", "-c", commands + doctor}).out;
  };
  constexpr const char* kOn = "forces are on: polhem-v1";
  constexpr const char* kOff = "forces are off because the device does not know where its handle is";
  // A machine that is so busy that nothing comes for half a second makes an arm uncalibrated, and rightly.
  const auto isOnAfter = [&](const Words& machine, const std::string& commands) {
    std::string said;
    for (int tries = 0; tries < 3 && said.find(kOn) == std::string::npos; ++tries) said = after(machine, commands);
    return said;
  };
  EXPECT_THAT(isOnAfter({"--uncalibrated"}, calibrate + touch(0.3)), HasSubstr(kOn));
  EXPECT_THAT(after({"--uncalibrated"}, calibrate + "timeout -s KILL 2 " + touch(9) + "; sleep 0.5"), HasSubstr(kOff));
  EXPECT_THAT(after({"--uncalibrated", "--unplug-after", "400", "--replug-ms", "100"}, calibrate + touch(1.5)),
              HasSubstr(kOff));
  EXPECT_THAT(isOnAfter({"--uncalibrated", "--asks-from", "900"}, touch(2)), HasSubstr(kOn));
  // The same from a servo in a process of its own, which may write nothing but that.
  EXPECT_THAT(isOnAfter({"--uncalibrated"}, calibrate + touch(0.3) + " --service"), HasSubstr(kOn));
  EXPECT_THAT(after({"--uncalibrated"}, calibrate + touch(9) + " --service & run=$!; sleep 3; " +
                                            "pkill -KILL -P $run -x palpate-servo; wait $run"),
              HasSubstr(kOff));
  if (isLongRun()) {
    EXPECT_THAT(isOnAfter({"--uncalibrated", "--asks-from", "900"}, touch(2) + " --service"), HasSubstr(kOn));
  }
}

TEST_F(HidDoctor, CalibratesOnlyWhatNeedsIt) {
  EXPECT_THAT(on({}, {"calibrate", "--device", "simulated"}).out, HasSubstr("simulated needs no calibration"));
  expectRefusal(on({"--devices", "none"}, {"calibrate", "--device", "polhem-v1", "--yes"}), "device polhem-v1",
                "none of", 3);
  EXPECT_EQ(on({}, {"calibrate"}).status, 2);
}

TEST_F(HidDoctor, ListsWhatIsHere) {
  const Outcome outcome = on({"--devices", "polhem,keyboard"}, {"devices"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.out, HasSubstr("1234:0006   mbed Polhem: polhem-v1 or woodenhaptics or woodenhaptics-2019 or "
                                     "aluhaptics or vintage"));
  EXPECT_EQ(outcome.out.find("Keyboard"), std::string::npos);
  EXPECT_THAT(on({"--devices", "none"}, {"devices"}).out, HasSubstr("None of them but the simulated one is here"));
}

// A user's own table, and one that is broken.
TEST_F(HidDoctor, TakesTheUsersTables) {
  std::filesystem::create_directories(file("palpate/devices"));
  write("palpate/devices/a.toml",
        "[[device]]\nname = \"mine\"\nfamily = \"polhem-family\"\nwhat = \"my own\"\nusb = [{ id = \"1234:0006\", "
        "report_bytes = 14 }]\n");
  write("palpate/devices/b.toml", "[[device]]\nname = \"other\"\n");
  const Words mine = {"--device", "mine", "--calibrated", "--current-limit", "3"};
  const Words touch = Words{"touch", "phantom:sphere?size=16", "--seconds", "0.2", "--picture", "off"};
  // One that cannot be read may be the one with the limits of this device: no force is exerted then.
  expectOff(doctor({}, mine), "a table of devices cannot be read, which may be about it; ");
  const Outcome refused = on({}, touch + mine);
  expectRefusal(refused, "--device mine: a table of devices cannot be read", "b.toml:1:1: a device has no 'family'", 2);
  EXPECT_THAT(on({}, touch + Words{"--device", "other"}).err, HasSubstr("b.toml:1:1: a device has no 'family'"));
  EXPECT_THAT(on({}, {"doctor", "--device", "other"}).err, HasSubstr("b.toml:1:1: a device has no 'family'"));
  const Json told = Json::parse(contentsOf(file("d.json")));
  EXPECT_TRUE(std::ranges::any_of(told["findings"], [](const Json& finding) {
    return finding["topic"] == "device tables" && finding["state"] == "OFF";
  }));
  std::filesystem::remove(file("palpate/devices/b.toml"));
  EXPECT_EQ(doctor({}, mine).status, 0);
  EXPECT_EQ(on({}, touch + mine).status, 0);
}

// What is no file is not waited for, and ends nothing that has to do with no device.
TEST_F(HidDoctor, LivesWithStrangeThingsAmongTheTables) {
  std::filesystem::create_directories(file("palpate/devices/folder.toml"));
  ASSERT_EQ(mkfifo(file("palpate/devices/pipe.toml").c_str(), 0600), 0);
  std::filesystem::create_symlink("/dev/zero", file("palpate/devices/zero.toml"));
  write("palpate/devices/large.toml", std::string(2'000'000, '#'));
  EXPECT_EQ(on({}, {"--version"}).status, 0);
  EXPECT_EQ(on({}, {"touch", "phantom:sphere?size=16", "--seconds", "0.2", "--picture", "off"}).status, 0);
  const Outcome outcome = on({}, {"devices"});
  EXPECT_EQ(outcome.status, 0);
  for (const char* file : {"folder.toml", "pipe.toml", "zero.toml"})
    EXPECT_THAT(outcome.err, HasSubstr(std::string(file) + ": the table of devices is no plain file"));
  EXPECT_THAT(outcome.err, HasSubstr("large.toml: the table of devices has"));
}

TEST_F(HidDoctor, RefusesNumbersThatAreNone) {
  for (const char* flag : {"--seconds", "--rate", "--current-limit"}) {
    for (const char* none : {"nan", "inf", "-1", "0", "1e9"})
      expectRefusal(on({}, {"doctor", flag, none}), flag, "is no number from", 2);
  }
  expectRefusal(on({}, {"doctor", "--device-path", "/dev/hidraw0"}), "--device-path", "--device", 2);
}

// An answer that is no Enter is no yes.
TEST_F(HidDoctor, CalibratesOnlyAfterEnter) {
  const auto answered = [&](const std::string& answer) {
    return emulate({"--uncalibrated"},
                   {"sh", "-c", fmt::format("printf '{}' | {} calibrate --device polhem-v1", answer, PALPATE_PROGRAM)});
  };
  EXPECT_EQ(answered("\\n").status, 0);
  EXPECT_EQ(answered("no\\n").status, 2);
  EXPECT_EQ(answered("").status, 2);
}

// A handle that moves at 0.4 m/s is not in its home position, whoever says so; nor is one that a calibrated arm says is
// elsewhere.
TEST_F(HidDoctor, CalibratesNoHandleThatMovesOrIsElsewhere) {
  std::string csv = "time_s,x_m,y_m,z_m\n";
  for (int i = 0; i <= 200; ++i) csv += fmt::format("{},{},0,0\n", 0.25 * i, i % 2 == 0 ? -0.05 : 0.05);
  write("way.csv", csv);
  const std::string program = PALPATE_PROGRAM;
  const Words calibrate = {"calibrate", "--device", "polhem-v1", "--yes"};
  expectRefusal(on({"--uncalibrated", "--paced", "--path", "way.csv"}, calibrate), "device polhem-v1",
                "not calibrated: the handle moved; hold it still in its home position", 6);
  const std::string moved = program + " calibrate --device polhem-v1 --yes";
  write("still.csv", "time_s,x_m,y_m,z_m\n0,0,0,0\n2,0,0,0\n2.5,0.1,0,0\n");
  const Outcome elsewhere = emulate(
      {"--uncalibrated", "--paced", "--path", "still.csv"},
      {"sh", "-c",
       moved + " && sleep 0.1 && " + program + " doctor --seconds 4 --device polhem-v1 --current-limit 3 && " + moved});
  EXPECT_EQ(elsewhere.status, 6) << elsewhere.out;
  EXPECT_THAT(elsewhere.err, HasSubstr("the arm is calibrated, and its handle was not in its home position"));
}

// Motors that nobody has checked: 1 N at most, said at the start of a run and by the doctor. The check ends that.
TEST_F(HidDoctor, ChecksMotors) {
  motors_checked_ = false;
  // Right, up, towards the user by 60 mm each, once the motors have pushed.
  write("hand.csv",
        "time_s,x_m,y_m,z_m\n0,0,0,0\n0.4,0.06,0,0\n2.4,0.06,0,0\n2.8,0.06,0,0.06\n4.8,0.06,0,0.06\n5.2,0.06,-0.06,0."
        "06\n");
  const std::string program = PALPATE_PROGRAM, arm = " --device polhem-v1 --calibrated";
  const std::string doctor = program + " doctor --seconds 0.3 --current-limit 3" + arm;
  const std::string check = program + " calibrate --check" + arm;
  const Words machine = {"--paced", "--path", "hand.csv", "--waits", "3000"};
  const Outcome outcome = emulate(machine, {"sh", "-c", doctor + " && " + check + " && " + doctor});
  EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
  const std::size_t found = outcome.out.find("The motors of polhem-v1 pull the right way, which is kept in ");
  ASSERT_NE(found, std::string::npos) << outcome.out;
  EXPECT_THAT(outcome.out.substr(0, found),
              HasSubstr("nobody has checked that its motors pull the right way, so forces stay below 1 N, whatever arm "
                        "it is; run 'palpate calibrate --device polhem-v1 --check'\n"));
  EXPECT_THAT(outcome.out.substr(0, found), HasSubstr("Now move the handle towards you by some 6 cm"));
  EXPECT_THAT(outcome.out.substr(0, found),
              HasSubstr("by its reports it could be woodenhaptics (links of 205 and 245 mm"));
  EXPECT_THAT(outcome.out.substr(found), testing::Not(HasSubstr("nobody has checked")));
  EXPECT_THAT(outcome.out.substr(found), HasSubstr("forces are on: polhem-v1\n"));
}

TEST_F(HidDoctor, NamesMotorsThatAreNotRight) {
  motors_checked_ = false;
  const Words check = {"calibrate", "--check", "--device", "polhem-v1", "--calibrated"};
  const Outcome reversed = on({"--paced", "--motors", "0,1,2:-1,1,1"}, check);
  expectRefusal(reversed, "device polhem-v1", "motor a turns the wrong way; swap the two leads of motor a", 6);
  EXPECT_THAT(on({"--paced", "--motors", "1,0,2:1,1,1"}, check).err,
              HasSubstr("encoder b answers to motor a, encoder a answers to motor b; see that the plugs of"));
  EXPECT_FALSE(std::filesystem::exists(file("state/palpate/motors")));
  EXPECT_THAT(on({}, {"calibrate", "--device", "polhem-v1", "--calibrated"}).err, HasSubstr("--check"));
  EXPECT_EQ(on({"--devices", "spacemouse"}, {"calibrate", "--check", "--device", "spacemouse"}).status, 0);
}

// A check keeps to the limits of its kind: pushes of up to 0.25 N would be needed to see motor a of this arm at once,
// in this hand. A kind that may not push at all cannot be checked.
TEST_F(HidDoctor, ChecksMotorsWithinTheLimitsOfTheirKind) {
  motors_checked_ = false;
  constexpr double kLimit_N = 0.12, kRounding_N = 0.02;
  const auto kind = [](const char* name, double limit_N) {
    return fmt::format(
        "[[device]]\nname = \"{}\"\nfamily = \"polhem-family\"\nwhat = \"weak\"\nusb = [{{ id = \"1234:0006\", "
        "report_bytes = 14 }}]\nvalues = {{ force_limit_N = {} }}\n",
        name, limit_N);
  };
  std::filesystem::create_directories(file("palpate/devices"));
  write("palpate/devices/a.toml", kind("weak", kLimit_N) + kind("none", 0));
  const auto check = [](const char* name) { return Words{"calibrate", "--check", "--device", name, "--calibrated"}; };
  const Outcome weak = on({"--paced", "--motors", "0,1,2:-1,-1,-1", "--log", "arm"}, check("weak"));
  expectRefusal(weak, "device weak",
                "motor a turns the wrong way, motor b turns the wrong way, motor c turns the wrong way", 6);
  std::istringstream account(contentsOf(file("arm")));
  double largest_N = 0;
  for (std::string word; account >> word;)
    if (word == "force_max_N") account >> largest_N;
  EXPECT_LE(largest_N, kLimit_N + kRounding_N);
  EXPECT_GE(largest_N, kLimit_N - kRounding_N);
  expectRefusal(on({"--paced"}, check("none")), "--check", "the motors of none may not push: the force limit is 0", 2);
}

// As another kind it would count from another home.
TEST_F(HidDoctor, IsNotCalibratedAsAnotherKind) {
  const std::string program = PALPATE_PROGRAM;
  const Outcome outcome =
      emulate({"--uncalibrated"}, {"sh", "-c",
                                   program + " calibrate --device polhem-v1 --yes && " + program +
                                       " doctor --seconds 0.2 --device woodenhaptics --current-limit 3"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.out, HasSubstr("forces are off because the device does not know where its handle is"));
}

// A second program would take away the first one's force, every other report.
TEST_F(HidDoctor, LeavesADeviceToTheProgramThatUsesIt) {
  const std::string program = PALPATE_PROGRAM;
  const Outcome outcome =
      emulate({"--paced"}, {"sh", "-c",
                            program +
                                " touch phantom:sphere?size=16 --device polhem-v1 --calibrated --current-limit 3 "
                                "--seconds 4 --picture off & sleep 2; XDG_RUNTIME_DIR=/another " +
                                program + " doctor --seconds 0.2 --device polhem-v1; wait"});
  EXPECT_THAT(outcome.out, HasSubstr("another program of Palpate uses it (process "));
}

}  // namespace hid_doctor_test
}  // namespace palpate
