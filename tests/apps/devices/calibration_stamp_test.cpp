// SPDX-License-Identifier: Apache-2.0
#include "apps/devices/calibration_stamp.hpp"

#include <cstdlib>
#include <fstream>

#include <gtest/gtest.h>

#include "tests/apps/report/temporary_folder.hpp"

namespace palpate {
namespace calibration_stamp_test {

class CalibrationStamp : public testing::Test {
 protected:
  CalibrationStamp() { setenv("XDG_RUNTIME_DIR", folder_.path().c_str(), 1); }
  ~CalibrationStamp() override { unsetenv("XDG_RUNTIME_DIR"); }
  std::string node(const std::string& name) const {
    const std::filesystem::path path = folder_.path() / name;
    std::ofstream(path) << "x";
    return path.string();
  }
  TemporaryFolder folder_;
};

// A device that is plugged in again has another file, of the same name.
TEST_F(CalibrationStamp, HoldsAsLongAsTheDeviceStays) {
  const std::string one = node("hidraw0"), other = node("hidraw1");
  EXPECT_FALSE(isStampedCalibrated(one));
  EXPECT_TRUE(stampCalibrated(one));
  EXPECT_TRUE(isStampedCalibrated(one));
  EXPECT_FALSE(isStampedCalibrated(other));
  std::filesystem::remove(one);
  EXPECT_FALSE(isStampedCalibrated(one));
  const std::string keeper = node("keeps the inode");
  EXPECT_EQ(node("hidraw0"), one);
  EXPECT_FALSE(isStampedCalibrated(one));
}

TEST_F(CalibrationStamp, IsNoneWhereItCannotBeKept) {
  const std::string one = node("hidraw0");
  EXPECT_FALSE(stampCalibrated((folder_.path() / "none").string()));
  for (const char* folder : {"", "relative", "/proc/none"}) {
    setenv("XDG_RUNTIME_DIR", folder, 1);
    EXPECT_FALSE(stampCalibrated(one)) << folder;
    EXPECT_FALSE(isStampedCalibrated(one)) << folder;
  }
  unsetenv("XDG_RUNTIME_DIR");
  EXPECT_FALSE(stampCalibrated(one));
  EXPECT_FALSE(isStampedCalibrated(one));
}

}  // namespace calibration_stamp_test
}  // namespace palpate
