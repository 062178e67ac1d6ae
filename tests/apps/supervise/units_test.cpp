// SPDX-License-Identifier: Apache-2.0
// The units in share/systemd/user: what they must say for the service to work as docs/service.md has it, and that
// systemd itself takes them. (Whether the verbs that they start exist is tested with the program.)
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>

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
