// SPDX-License-Identifier: Apache-2.0
#include "apps/doctor/udev_rules.hpp"

#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/apps/report/temporary_folder.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace udev_rules_test {

using testing::HasSubstr;

// Each pair of numbers once, though five arms share two of them.
TEST(UdevRules, HaveARuleForEachPairOfNumbers) {
  const std::string rules = udevRules(knownDeviceKinds());
  EXPECT_THAT(rules, HasSubstr("KERNEL==\"hidraw*\", ATTRS{idVendor}==\"1234\", ATTRS{idProduct}==\"0006\", "
                               "MODE=\"0660\", TAG+=\"uaccess\"\n"));
  EXPECT_THAT(rules, HasSubstr("SUBSYSTEM==\"usb\", ATTR{idVendor}==\"16c0\", ATTR{idProduct}==\"0486\""));
  std::istringstream lines(rules);
  std::set<std::string> seen;
  std::size_t count = 0;
  for (std::string line; std::getline(lines, line); ++count) EXPECT_TRUE(seen.insert(line).second) << line;
  std::set<std::pair<int, int>> ids;
  for (const DeviceKind& kind : knownDeviceKinds())
    for (const UsbId& usb : kind.usb) ids.emplace(usb.vendor, usb.product);
  EXPECT_EQ(count, 1 + 2 * ids.size());
  for (const auto& [vendor, product] : ids) {
    EXPECT_THAT(rules, HasSubstr(udevRule(static_cast<std::uint16_t>(vendor), static_cast<std::uint16_t>(product))));
  }
}

TEST(UdevRules, AreWrittenWholeOrRefusedWithTheCommandThatMay) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "70.rules";
  EXPECT_FALSE(hasUdevRule(file, "a rule\n"));
  installUdevRules(file, "one\na rule\nanother\n");
  EXPECT_TRUE(hasUdevRule(file, "a rule\n"));
  EXPECT_FALSE(hasUdevRule(file, "a third\n"));
  EXPECT_THAT(refusalOf([&] { installUdevRules(folder.path() / "none" / "70.rules", "a rule\n"); }, Error::Code::kIo),
              HasSubstr("none && sudo palpate doctor --install-udev"));
  EXPECT_THAT(refusalOf([&] { installUdevRules("/proc/70.rules", "a rule\n"); }, Error::Code::kIo),
              HasSubstr("sudo palpate doctor --install-udev"));
}

}  // namespace udev_rules_test
}  // namespace palpate
