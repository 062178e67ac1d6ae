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
  static CalibratedAs as(const std::string& path, const std::string& kind = "arm", double home = 5) {
    return {.path = path, .kind = kind, .values = {{"home_a", home}}};
  }
  TemporaryFolder folder_;
};

// A device that is plugged in again has another file, of the same name.
TEST_F(CalibrationStamp, HoldsAsLongAsTheDeviceStays) {
  const std::string one = node("hidraw0"), other = node("hidraw1");
  EXPECT_FALSE(isStampedCalibrated(as(one)));
  EXPECT_TRUE(stampCalibrated(as(one)));
  EXPECT_TRUE(isStampedCalibrated(as(one)));
  EXPECT_FALSE(isStampedCalibrated(as(other)));
  std::filesystem::remove(one);
  EXPECT_FALSE(isStampedCalibrated(as(one)));
  const std::string keeper = node("keeps the inode");
  EXPECT_EQ(node("hidraw0"), one);
  EXPECT_FALSE(isStampedCalibrated(as(one)));
}

// Driven as another kind, or with another home, it counts from elsewhere.
TEST_F(CalibrationStamp, IsOfOneKindWithItsValues) {
  const std::string one = node("hidraw0");
  EXPECT_TRUE(stampCalibrated(as(one)));
  EXPECT_FALSE(isStampedCalibrated(as(one, "another arm")));
  EXPECT_FALSE(isStampedCalibrated(as(one, "arm", 6)));
  EXPECT_FALSE(isStampedCalibrated({.path = one, .kind = "arm"}));
  EXPECT_TRUE(isStampedCalibrated(as(one)));
  forgetCalibration(node("hidraw1"));
  EXPECT_TRUE(isStampedCalibrated(as(one)));
  forgetCalibration(one);
  EXPECT_FALSE(isStampedCalibrated(as(one)));
}

TEST_F(CalibrationStamp, IsNoneWhereItCannotBeKept) {
  const std::string one = node("hidraw0");
  EXPECT_FALSE(stampCalibrated(as((folder_.path() / "none").string())));
  for (const char* folder : {"", "relative", "/proc/none"}) {
    setenv("XDG_RUNTIME_DIR", folder, 1);
    EXPECT_FALSE(stampCalibrated(as(one))) << folder;
    EXPECT_FALSE(isStampedCalibrated(as(one))) << folder;
  }
  unsetenv("XDG_RUNTIME_DIR");
  EXPECT_FALSE(stampCalibrated(as(one)));
  EXPECT_FALSE(isStampedCalibrated(as(one)));
}

}  // namespace calibration_stamp_test
}  // namespace palpate
