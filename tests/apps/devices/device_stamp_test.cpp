// SPDX-License-Identifier: Apache-2.0
#include "apps/devices/device_stamp.hpp"

#include <fstream>

#include <gtest/gtest.h>

#include "tests/apps/report/temporary_folder.hpp"

namespace palpate {
namespace device_stamp_test {

TEST(DeviceStamp, IsThereWithItsWordsAlone) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "a" / "b" / "stamp";
  const DeviceStamp stamp(file, "one\n"), other(file, "two\n");
  EXPECT_FALSE(stamp.isThere());
  EXPECT_TRUE(stamp.put());  // which makes the folders
  EXPECT_EQ(contentsOf(file), "one\n");
  EXPECT_TRUE(stamp.isThere());
  EXPECT_FALSE(other.isThere());
  std::ofstream(file, std::ios::app) << "more\n";
  EXPECT_FALSE(stamp.isThere());
  EXPECT_TRUE(stamp.put());
  EXPECT_TRUE(stamp.isThere());
  other.remove();
  EXPECT_FALSE(std::filesystem::exists(file));
  other.remove();
}

TEST(DeviceStamp, IsNoneWhereItCannotBeKept) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "file") << "x";
  for (const DeviceStamp& stamp :
       {DeviceStamp({}, "one\n"), DeviceStamp(folder.path() / "stamp", ""),
        DeviceStamp(folder.path() / "file" / "stamp", "one\n"), DeviceStamp("/proc/none/s", "x")}) {
    EXPECT_FALSE(stamp.put()) << stamp.file();
    EXPECT_FALSE(stamp.isThere()) << stamp.file();
    stamp.remove();
  }
  EXPECT_EQ(folder.files(), 1);
}

}  // namespace device_stamp_test
}  // namespace palpate
