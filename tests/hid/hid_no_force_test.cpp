// SPDX-License-Identifier: Apache-2.0
// Ten kinds of "no force", and that the doctor or the run names each one.
#include <unistd.h>

#include "emulated_program.hpp"

namespace palpate {
namespace hid_no_force_test {

using testing::HasSubstr;

constexpr const char* kPhantom = "phantom:sphere?size=32";

class NoForce : public EmulatedHid {
 protected:
  [[nodiscard]] std::string verdict(const Words& machine, const Words& more) const {
    return on(machine, Words{"doctor", "--seconds", "0.2"} + more).out;
  }
  [[nodiscard]] Outcome touch(const Words& more) const {
    return run(Words{"touch", kPhantom, "--seconds", "1", "--picture", "off", "--clock", "simulated"} + more);
  }
  [[nodiscard]] Words asNobody(const Words& program) const {
    std::filesystem::permissions(folder(), std::filesystem::perms::all);
    return Words{"setpriv", "--reuid=65534", "--clear-groups", PALPATE_PROGRAM} + program;
  }
  // The driver loses the device after so many submissions.
  [[nodiscard]] Outcome touchUntilLost(int submissions, const Words& more) const {
    write("faults.json",
          std::string(R"({"file_format_version": "1.0.0", "layer": {"name": "VK_LAYER_palpate_faults", )") +
              R"("type": "GLOBAL", "api_version": "1.3.0", "implementation_version": "1", )" +
              R"("description": "loses the device", "library_path": ")" + PALPATE_FAULTS_LAYER + R"("}})");
    write("fault", fmt::format("submit -4 {}", submissions));
    const Command command{
        .arguments = Words{"touch", kPhantom, "--seconds", "2", "--picture", "off", "--clock", "simulated"} + more,
        .folder = folder(),
        .environment = {{"VK_INSTANCE_LAYERS", "VK_LAYER_palpate_faults"},
                        {"VK_LAYER_PATH", "/usr/share/vulkan/explicit_layer.d:" + folder().string()},
                        {"PALPATE_VULKAN_FAULT", file("fault").string()}}};
    const Outcome outcome = runPalpate(command);
    EXPECT_FALSE(exists("fault")) << "the device was not lost";
    return outcome;
  }
};

const Words kPolhem = {"--device", "polhem-v1"};
const Words kReadyPolhem = {"--device", "polhem-v1", "--calibrated", "--current-limit", "3"};

TEST_F(NoForce, NoDevice) {
  EXPECT_THAT(verdict({"--devices", "none"}, {}), HasSubstr("forces are off because no haptic device is here"));
}

TEST_F(NoForce, NoPermission) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can become another user";
  const Outcome outcome = emulate({"--forbidden"}, asNobody(Words{"touch", kPhantom} + kReadyPolhem));
  EXPECT_EQ(outcome.status, 6);
  EXPECT_THAT(outcome.err, HasSubstr("/dev/hidraw0: you have no right to use it; run 'palpate doctor --install-udev'"));
}

TEST_F(NoForce, WrongFirmware) {
  EXPECT_THAT(verdict({"--devices", "gadget"}, kPolhem),
              HasSubstr("1234:0006 \"A lamp\" at /dev/hidraw0 has its USB numbers, but"));
}

TEST_F(NoForce, Uncalibrated) {
  EXPECT_THAT(verdict({"--uncalibrated"}, {"--device", "polhem-v1", "--current-limit", "3"}),
              HasSubstr("forces are off because the device does not know where its handle is"));
}

TEST_F(NoForce, LimitZero) {
  std::filesystem::create_directories(file("palpate/devices"));
  write("palpate/devices/a.toml",
        "[[device]]\nname = \"weak\"\nfamily = \"polhem-family\"\nwhat = \"none\"\nusb = [{ id = \"1234:0006\", "
        "report_bytes = 14 }]\nvalues = { force_limit_N = 0 }\n");
  const Words weak = {"--device", "weak", "--calibrated", "--current-limit", "3"};
  EXPECT_THAT(verdict({}, weak), HasSubstr("forces are off because the force limit is 0"));
  const Outcome outcome =
      on({}, Words{"touch", kPhantom, "--seconds", "0.1", "--clock", "simulated", "--picture", "off"} + weak);
  EXPECT_THAT(outcome.err, HasSubstr("forces are off because the force limit is 0"));
}

// The editing session lost the device, the servo goes on.
TEST_F(NoForce, StaleWindow) {
  const Outcome outcome = touchUntilLost(12, {"--edit", "remove:radius=2mm"});
  EXPECT_THAT(outcome.out, HasSubstr("stale-window in "));
  EXPECT_THAT(outcome.out, HasSubstr("the engine has not confirmed the samples in time; the force falls to zero"));
}

// On a path that begins in the middle.
TEST_F(NoForce, InsideTheObject) {
  write("way.csv", "time_s,x_m,y_m,z_m\n0,0,0,0\n0.5,0.001,0,0\n");
  const Outcome outcome = touch({"--path", "way.csv"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("inside-object in "));
  EXPECT_THAT(outcome.out, HasSubstr("the tool was inside the object without having entered it"));
  EXPECT_THAT(outcome.out, HasSubstr("the force is none until the tool has been outside once"));
}

// No sample of the surface was ever made. It ends, and waits for nothing that will never be done.
TEST_F(NoForce, EngineFailed) {
  for (const int submissions : {0, 1, 2, 3}) {
    const Outcome outcome = touchUntilLost(submissions, {});
    EXPECT_FALSE(outcome.timed_out) << submissions;
    EXPECT_EQ(outcome.status, 6) << submissions << ": " << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("the driver failed in '"));
  }
}

TEST_F(NoForce, IsovalueOff) {
  expectRefusal(touch({"--iso", "1e6"}), "phantom:sphere", "1e+06 is outside its values", 2);
  expectRefusal(touch({"--iso", "-1e6"}), "phantom:sphere", "-1e+06 is outside its values", 2);
}

TEST_F(NoForce, NoRealTimeRights) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can become another user";
  const Outcome outcome = emulate({"--forbidden"}, asNobody({"touch", kPhantom, "--require-real-time"}));
  EXPECT_EQ(outcome.status, 6);
  EXPECT_THAT(outcome.err, HasSubstr("no real-time priority"));
  const Outcome doctor = emulate({}, asNobody({"doctor", "--seconds", "0.2"}));
  EXPECT_EQ(doctor.status, 1) << doctor.err;
  EXPECT_THAT(doctor.out, HasSubstr("note  real time"));
}

}  // namespace hid_no_force_test
}  // namespace palpate
