// SPDX-License-Identifier: Apache-2.0
// Kinds of devices as data: the program's own, the user's, and what is refused in a file.
#include "apps/devices/device_table.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <set>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "servo/devices/arm_kinematics.hpp"
#include "servo/devices/polhem_device.hpp"
#include "tests/apps/report/temporary_folder.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace device_table_test {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kOne = R"(
[[device]]
name = "mine"
family = "polhem-family"
what = "my own"
usage = "ffab:0200"
usb = ["1234:0006", { id = "16C0:0486", report_bytes = 64 }]
[device.values]
force_limit_N = 3
)";

// Of each board what it states itself, else what its kind states, else what the family's devices usually have.
TEST(DeviceTable, KnowsWhatEachBoardMayHave) {
  const DeviceKind kind = readDeviceKinds(kOne, "mine.toml").at(0);
  EXPECT_THAT(kind.eachValueOf("report_bytes"), ElementsAre(14, 64));
  EXPECT_THAT(kind.eachValueOf("force_limit_N"), ElementsAre(3, 3));
  EXPECT_THAT(kind.eachValueOf("current_limit_A"), ElementsAre(0, 0));
  EXPECT_THAT(kind.eachValueOf("interval_s"), ElementsAre()) << "of another family";
}

// The ranges of the joints of the program's own arms hold their workspaces and their homes, with 25 degrees to spare.
TEST(DeviceTable, GivesArmsRoomForTheirWorkspaces) {
  int arms = 0;
  for (const DeviceKind& kind : deviceKinds({})) {
    if (kind.family != "polhem-family") continue;
    ++arms;
    const PolhemParameters p = polhemParametersOf(kind.values);
    const ArmKinematics arm(p.joints, p.origin_m);
    const auto fits = [&](const Vec3& angles) {
      constexpr double kSpare_rad = 25 * std::numbers::pi / 180;
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_GE(angles[static_cast<int>(k)] - kSpare_rad, p.lowest_rad[k]) << kind.name << k;
        EXPECT_LE(angles[static_cast<int>(k)] + kSpare_rad, p.highest_rad[k]) << kind.name << k;
      }
    };
    fits(arm.angles({p.home_counts[0], p.home_counts[1], p.home_counts[2]}));
    for (int i = 0; i < 1000; ++i) {
      // Evenly over the ball's surface (Fibonacci), where the angles are furthest from those of the middle.
      const double up = 1 - (2 * i + 1) / 1000.0, around = 2.399963 * i, out = std::sqrt(1 - up * up);
      const auto angles = arm.anglesAt(p.workspace_radius_m * Vec3(out * std::cos(around), out * std::sin(around), up));
      if (angles) fits(*angles);  // some reach no further than a part of it
    }
  }
  EXPECT_EQ(arms, 5);
}

// docs/devices.md tells arms apart that have the same USB numbers: its table is made of the values of devices.toml.
TEST(DeviceTable, IsTheTableOfThePage) {
  std::string table =
      "   | kind | what it is | link b | link c | torque of motors a, b, c |\n   |---|---|---|---|---|\n";
  int arms = 0;
  for (const DeviceKind& kind : deviceKinds({})) {
    if (kind.family != "polhem-family") continue;
    ++arms;
    const auto value = [&](const char* key) { return kind.values.at(key); };
    table += fmt::format("   | `{}` | {} | {:g} mm | {:g} mm | {:g}, {:g}, {:g} Nm/A |\n", kind.name,
                         kind.what.substr(0, kind.what.find(':')), 1e3 * value("length_b_m"), 1e3 * value("length_c_m"),
                         value("torque_a_Nm_per_A"), value("torque_b_Nm_per_A"), value("torque_c_Nm_per_A"));
  }
  const std::string page = contentsOf(PALPATE_DOCS "/devices.md");
  EXPECT_NE(page.find(table + "\n"), std::string::npos) << "docs/devices.md must hold:\n" << table;
  EXPECT_EQ(arms, 5) << "docs/devices.md speaks of five arms";
  EXPECT_THAT(page, HasSubstr("Five arms have the same USB numbers"));
  EXPECT_THAT(page, HasSubstr("for the five arms"));
}

TEST(DeviceTable, ReadsAKind) {
  const std::vector<DeviceKind> kinds = readDeviceKinds(kOne, "a.toml");
  ASSERT_EQ(kinds.size(), 1U);
  const DeviceKind& kind = kinds.front();
  EXPECT_EQ(kind.name, "mine");
  EXPECT_EQ(kind.family, "polhem-family");
  EXPECT_EQ(kind.what, "my own");
  EXPECT_EQ(kind.file, "a.toml");
  EXPECT_EQ(kind.usage, std::pair(std::uint16_t{0xFFAB}, std::uint16_t{0x0200}));
  EXPECT_EQ(kind.values, (DeviceValues{{"force_limit_N", 3}}));
  ASSERT_EQ(kind.usb.size(), 2U);
  EXPECT_TRUE(kind.usb[0].values.empty());
  EXPECT_EQ(kind.idOf(0x16C0, 0x0486)->values, (DeviceValues{{"report_bytes", 64}}));
  EXPECT_EQ(kind.idOf(0x1234, 0x0007), nullptr);
  EXPECT_EQ(usbText(0x16C0, 0x0486), "16c0:0486");
  EXPECT_TRUE(readDeviceKinds("", "b.toml").empty());
}

// Each change of the text above is refused with its place and the reason.
TEST(DeviceTable, RefusesWhatIsNoKind) {
  struct Case {
    const char *from, *to, *reason;
  };
  for (const Case& c : {Case{"name = \"mine\"", "", "a device has no 'name'"},
                        Case{"\"mine\"", "\"\"", "'name' is no text"},
                        Case{"\"mine\"", "3", "'name' is no text"},
                        Case{"\"mine\"", "\"simulated\"", "'simulated' is a name of its own"},
                        Case{"polhem-family", "polhem-famili", "did you mean polhem-family?"},
                        Case{"polhem-family", "simulated", "there is no family 'simulated'"},
                        Case{"what =", "whut =", "did you mean what?"},
                        Case{"ffab:0200", "ffab", "'usage' is not two hexadecimal numbers"},
                        Case{"1234:0006", "1234:00066", "'usb' is not two hexadecimal numbers"},
                        Case{"1234:0006", "1234:000g", "'usb' is not two hexadecimal numbers"},
                        Case{"1234:0006", ":0006", "'usb' is not two hexadecimal numbers"},
                        Case{"id = ", "ib = ", "it has no 'id'"},
                        Case{"report_bytes = 64", "report_bytes = 65", "'report_bytes' is out of range"},
                        Case{"report_bytes = 64", "raport_bytes = 64", "did you mean report_bytes?"},
                        Case{"force_limit_N = 3", "force_limit_N = -1", "'force_limit_N' is out of range"},
                        Case{"force_limit_N = 3", "force_limit_N = nan", "'force_limit_N' is out of range"},
                        Case{"force_limit_N = 3", "force_limit_N = \"3\"", "'force_limit_N' is no number"},
                        Case{"force_limit_N = 3", "force_limit_N = true", "'force_limit_N' is no number"},
                        Case{"force_limit_N = 3", "home_a = 0.5", "'home_a' is no whole number"},
                        Case{"force_limit_N = 3", "aligned_b = 0.5", "'aligned_b' is no whole number"},
                        Case{"force_limit_N = 3", "origin_x_m = 5", "origin of the workspace: the arm does not reach"},
                        Case{"report_bytes = 64", "report_bytes = 20", "report size: 20 cannot be used"},
                        Case{"report_bytes = 64", "report_bytes = 14.5", "'report_bytes' is no whole number"},
                        Case{"\"mine\"", "\"mi\\u001bne\"", "'name' has a control character"},
                        Case{"\"mine\"", "\"mi\\nne\"", "'name' has a control character"},
                        Case{"[[device]]", "[device]", "'device' is no list of tables"},
                        Case{"[[device]]", "device = [1]\n[x]", ""},
                        Case{"[[device]]", "[[devise]]", "there is no key 'devise'"},
                        Case{"[\"1234:0006\", ", "[ , ", ""}}) {
    std::string text = kOne;
    text.replace(text.find(c.from), std::string(c.from).size(), c.to);
    const std::string refusal = refusalOf([&] { static_cast<void>(readDeviceKinds(text, "a.toml")); });
    EXPECT_THAT(refusal, HasSubstr("a.toml:")) << c.to;
    EXPECT_THAT(refusal, HasSubstr(c.reason)) << c.to;
  }
  const std::string twice = std::string(kOne) + kOne;
  EXPECT_THAT(refusalOf([&] { static_cast<void>(readDeviceKinds(twice, "a.toml")); }), HasSubstr("is there twice"));
  EXPECT_THAT(refusalOf([&] { static_cast<void>(readDeviceKinds("device = [3]", "a.toml")); }),
              HasSubstr("it is no table"));
}

// Each kind that the program brings can be made, and an arm has its home where its links can be.
TEST(DeviceTable, BringsKindsThatCanBe) {
  std::set<std::string> names;
  for (const DeviceKind& kind : deviceKinds("/none")) {
    EXPECT_TRUE(names.insert(kind.name).second);
    EXPECT_TRUE(kind.file.empty());
    EXPECT_FALSE(kind.usb.empty());
    EXPECT_TRUE(deviceEntry(kind.family).needs_port);
    if (kind.family != "polhem-family") continue;
    const auto value = [&](const std::string& key) { return kind.values.at(key); };
    std::array<ArmJoint, 3> joints;
    for (int k = 0; k < 3; ++k) {
      const std::string joint(1, "abc"[k]);
      joints[static_cast<std::size_t>(k)] = {value("capstan_" + joint + "_m"), value("body_" + joint + "_m"),
                                             value("length_" + joint + "_m"),  value("torque_" + joint + "_Nm_per_A"),
                                             value("counts_" + joint),         value("aligned_" + joint) > 0};
    }
    const ArmKinematics arm(joints, {value("origin_x_m"), value("origin_y_m"), value("origin_z_m")});
    const ArmCounts home = {std::int64_t(value("home_a")), std::int64_t(value("home_b")),
                            std::int64_t(value("home_c"))};
    EXPECT_LT(arm.position(arm.angles(home)).norm(), 0.6) << kind.name;
    EXPECT_TRUE(arm.anglesAt(Vec3::Zero())) << kind.name;  // the workspace's middle is within reach
    EXPECT_GT(value("force_limit_N"), 0);
  }
  EXPECT_TRUE(names.contains("polhem-v1") && names.contains("woodenhaptics") && names.contains("spacemouse"));
}

// The family's usual values are those of Polhem v1; the table says them again, and must say the same. But the ranges of
// joints: a kind of a user's own that states none has none, whatever the lengths of its links.
TEST(DeviceTable, AgreesWithTheFamilysUsualValues) {
  const DeviceKind* kind = deviceKindNamed("polhem-v1");
  ASSERT_NE(kind, nullptr);
  for (const auto& [key, value] : kind->values) {
    if (key.ends_with("_rad")) continue;
    EXPECT_EQ(deviceParameter("polhem-family", key).usual, value) << key;
  }
}

TEST(DeviceTable, TakesTheUsersKindsToo) {
  const TemporaryFolder folder;
  EXPECT_EQ(deviceKinds(folder.path()).size(), deviceKinds("/none").size());
  std::ofstream(folder.path() / "b.toml") << kOne;
  std::string other = kOne;
  other.replace(other.find("mine"), 4, "polhem-v1");
  std::ofstream(folder.path() / "a.toml") << other;
  std::ofstream(folder.path() / "c.txt") << "no table";
  const std::vector<DeviceKind> all = deviceKinds(folder.path());
  EXPECT_EQ(all.size(), deviceKinds("/none").size() + 1);
  const auto replaced = std::ranges::find(all, "polhem-v1", &DeviceKind::name);
  ASSERT_NE(replaced, all.end());
  EXPECT_EQ(replaced->what, "my own");
  EXPECT_THAT(replaced->file, HasSubstr("a.toml"));
  std::ofstream(folder.path() / "d.toml") << "[[device]]\n";
  EXPECT_THAT(refusalOf([&] { static_cast<void>(deviceKinds(folder.path())); }), HasSubstr("d.toml"));
}

TEST(DeviceTable, NamesWhatUsersMayChoose) {
  const std::vector<std::string>& names = deviceNamesForUsers();
  EXPECT_EQ(names.front(), "simulated");
  EXPECT_EQ(std::ranges::count(names, "polhem-family"), 0);
  EXPECT_EQ(deviceKindNamed("simulated"), nullptr);
  EXPECT_THAT(refusalOf([] { static_cast<void>(deviceKindNamed("polhem-v9")); }), HasSubstr("did you mean polhem-v1?"));
}

}  // namespace device_table_test
}  // namespace palpate
