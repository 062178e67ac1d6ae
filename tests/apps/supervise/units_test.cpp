// SPDX-License-Identifier: Apache-2.0
// The units in share/systemd/user: what they must say for the service to work as docs/service.md has it, and that
// systemd itself takes them. (Whether the verbs that they start exist is tested with the program.)
#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>

#include "apps/devices/device_table.hpp"
#include "apps/scene/scene.hpp"
#include "apps/servo_side/servo_ceilings.hpp"
#include "apps/supervise/hopeless_statuses.hpp"
#include "temporary_folder.hpp"

namespace palpate {
namespace units_test {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Key;
using testing::Not;
using testing::Pair;

constexpr std::array kUnitNames = {"palpate-engine.service", "palpate-servo.service"};

using Settings = std::map<std::string, std::string>;  // "Service.Type" to its value

// The format without what these units do not use: continued lines, and keys that are given several times.
Settings settingsOf(const std::string& unit) {
  Settings settings;
  std::string section;
  std::istringstream lines(contentsOf(std::filesystem::path(PALPATE_UNITS) / unit));
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || line[0] == '#') continue;
    if (line.front() == '[' && line.back() == ']') {
      section = line.substr(1, line.size() - 2);
      continue;
    }
    const std::size_t equals = line.find('=');
    EXPECT_TRUE(!section.empty() && equals != line.npos && equals > 0 && line.back() != '\\') << unit << ": " << line;
    const bool is_new = settings.emplace(section + "." + line.substr(0, equals), line.substr(equals + 1)).second;
    EXPECT_TRUE(is_new) << unit << ": twice: " << line;
  }
  return settings;
}

TEST(Units, SayWhatTheyStart) {
  EXPECT_THAT(settingsOf("palpate-engine.service"),
              AllOf(Contains(Pair("Service.Type", "notify")),
                    Contains(Pair("Service.ExecStart", "palpate serve %h/.config/palpate/service.toml")),
                    Contains(Pair("Service.ExecReload", "kill -HUP $MAINPID")),
                    Contains(Pair("Service.Restart", "on-failure"))));
  EXPECT_THAT(settingsOf("palpate-servo.service"),
              AllOf(Contains(Pair("Service.ExecStart", "palpate servo --connect %t/palpate/service.sock")),
                    Contains(Pair("Service.Restart", "always")), Contains(Pair("Unit.StartLimitIntervalSec", "0")),
                    Contains(Pair("Service.LimitRTPRIO", "95")), Contains(Pair("Service.LimitMEMLOCK", "infinity"))));
}

// What systemd starts again is what `palpate serve --supervise` starts again: a servo whose ceilings cannot be read
// would else be started ten times a second for ever.
TEST(Units, StartNothingAgainThatIsHopeless) {
  const auto listOf = [](const std::vector<int>& statuses) { return fmt::format("{}", fmt::join(statuses, " ")); };
  EXPECT_THAT(settingsOf("palpate-engine.service"),
              Contains(Pair("Service.RestartPreventExitStatus", listOf(hopelessForEngine()))));
  EXPECT_THAT(settingsOf("palpate-servo.service"),
              Contains(Pair("Service.RestartPreventExitStatus", listOf(hopelessForServo()))));
}

// A servo that is killed while its force fades drops what is left of it. So systemd waits at least as long as
// `palpate serve --supervise` does, for each kind of device and whatever a scene asks for.
TEST(Units, WaitForTheServosLongestFade) {
  const std::string wait = settingsOf("palpate-servo.service")["Service.TimeoutStopSec"];
  ASSERT_TRUE(wait.ends_with("s") && !wait.ends_with("ms")) << wait;
  const double wait_s = std::stod(wait);
  EXPECT_GE(wait_s, kServosEnd_s + kMostFade_s);
  int kinds = 0;
  for (const DeviceKind& kind : deviceKinds({})) {
    SCOPED_TRACE(kind.name);
    Scene scene;
    scene.device = kind.name;
    EXPECT_LE(kServosEnd_s + longestFade_s(scene), wait_s);
    scene.slew_limit_N_per_s = 1;
    scene.force_scale = 0.001;
    EXPECT_LE(kServosEnd_s + longestFade_s(scene), wait_s);
    ++kinds;
  }
  EXPECT_GT(kinds, 0);
}

// A servo that is stopped or restarted with its engine would drop the force of a hand in contact.
TEST(Units, TheServoIsNotBoundToTheEngine) {
  const Settings servo = settingsOf("palpate-servo.service");
  for (const char* key : {"Unit.BindsTo", "Unit.PartOf", "Unit.Requires", "Unit.Requisite", "Service.RestrictRealtime",
                          "Service.PrivateDevices", "Service.PrivateNetwork"}) {
    EXPECT_THAT(servo, Not(Contains(Key(key))));
  }
}

TEST(Units, GiveAwayNoRights) {
  for (const char* unit : kUnitNames) {
    EXPECT_THAT(settingsOf(unit),
                AllOf(Contains(Pair("Service.NoNewPrivileges", "yes")), Contains(Pair("Service.ProtectSystem", "full")),
                      Contains(Pair("Service.RestrictAddressFamilies", "AF_UNIX AF_NETLINK")),
                      Contains(Pair("Service.SystemCallArchitectures", "native"))))
        << unit;
  }
}

// systemd-analyze looks at all units of a folder together, and at no others' programs.
class UnitsVerified : public testing::Test {
 protected:
  void SetUp() override {
    if (std::system("systemd-analyze --version > /dev/null 2>&1") != 0) {
      GTEST_SKIP() << "the units are not verified, since systemd-analyze is not on this machine";
    }
  }
  // A copy in which the program, which need not be installed here, is one that is there.
  void copyUnit(const std::string& unit, const std::string& more = "") const {
    std::string text = contentsOf(std::filesystem::path(PALPATE_UNITS) / unit);
    const std::string start = "\nExecStart=palpate ";
    ASSERT_NE(text.find(start), text.npos) << unit;
    text.replace(text.find(start), start.size(), "\nExecStart=/bin/true " + more);
    std::ofstream(folder_.path() / unit) << text;
  }
  // What it finds wrong in the copies. Empty: nothing.
  [[nodiscard]] std::string faults() const {
    const std::string folder = folder_.path().string();
    std::string command =
        fmt::format("cd {0} && HOME={0} XDG_RUNTIME_DIR={0} systemd-analyze --user --man=no verify", folder);
    for (const char* unit : kUnitNames) command += fmt::format(" ./{}", unit);
    const int status = std::system((command + " > words 2>&1").c_str());
    const std::string words = contentsOf(folder_.path() / "words");
    return status == 0 ? words : words + "(not accepted)";
  }

 private:
  TemporaryFolder folder_;
};

TEST_F(UnitsVerified, AreAcceptedBySystemd) {
  for (const char* unit : kUnitNames) copyUnit(unit);
  EXPECT_EQ(faults(), "");
}

TEST_F(UnitsVerified, AMistakeWouldBeFound) {
  copyUnit("palpate-engine.service");
  copyUnit("palpate-servo.service", "\nRestrictAddressFamilies=AF_UNIX AF_NETWORK\nExecStrat=");
  EXPECT_THAT(faults(), AllOf(HasSubstr("AF_NETWORK"), HasSubstr("ExecStrat")));
}

}  // namespace units_test
}  // namespace palpate
