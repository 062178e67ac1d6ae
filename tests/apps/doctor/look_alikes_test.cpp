// SPDX-License-Identifier: Apache-2.0
// docs/devices.md tells arms apart that have the same USB numbers: its table is made of the values of devices.toml.
#include <fstream>
#include <iterator>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/devices/device_table.hpp"

namespace palpate {
namespace look_alikes_test {

TEST(LookAlikes, AreTheTableOfThePage) {
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
  std::ifstream in(PALPATE_DOCS "/devices.md");
  const std::string page((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  EXPECT_NE(page.find(table + "\n"), std::string::npos) << "docs/devices.md must hold:\n" << table;
  EXPECT_EQ(arms, 5) << "docs/devices.md speaks of five arms";
  EXPECT_THAT(page, testing::HasSubstr("Five arms have the same USB numbers"));
  EXPECT_THAT(page, testing::HasSubstr("for the five arms"));
}

}  // namespace look_alikes_test
}  // namespace palpate
