// SPDX-License-Identifier: Apache-2.0
#include "apps/devices/calibration_stamp.hpp"

#include <cstdlib>
#include <fstream>

#include <gtest/gtest.h>

#include "tests/apps/report/temporary_folder.hpp"

namespace palpate {
namespace calibration_stamp_test {

class Stamps : public testing::Test {
 protected:
  Stamps() { setenv("XDG_RUNTIME_DIR", folder_.path().c_str(), 1); }
  ~Stamps() override { unsetenv("XDG_RUNTIME_DIR"); }
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
TEST_F(Stamps, HoldsAsLongAsTheDeviceStays) {
  const std::string one = node("hidraw0"), other = node("hidraw1");
  EXPECT_FALSE(CalibrationStamp(as(one)).isThere());
  EXPECT_TRUE(CalibrationStamp(as(one)).put());
  EXPECT_TRUE(CalibrationStamp(as(one)).isThere());
  EXPECT_FALSE(CalibrationStamp(as(other)).isThere());
  std::filesystem::remove(one);
  EXPECT_FALSE(CalibrationStamp(as(one)).isThere());
  const std::string keeper = node("keeps the inode");
  EXPECT_EQ(node("hidraw0"), one);
  EXPECT_FALSE(CalibrationStamp(as(one)).isThere());
}

// Driven as another kind, or with another home, it counts from elsewhere.
TEST_F(Stamps, IsOfOneKindWithItsValues) {
  const std::string one = node("hidraw0");
  EXPECT_TRUE(CalibrationStamp(as(one)).put());
  EXPECT_FALSE(CalibrationStamp(as(one, "another arm")).isThere());
  EXPECT_FALSE(CalibrationStamp(as(one, "arm", 6)).isThere());
  EXPECT_FALSE(CalibrationStamp({.path = one, .kind = "arm"}).isThere());
  EXPECT_TRUE(CalibrationStamp(as(one)).isThere());
  EXPECT_FALSE(CalibrationStamp(as(node("hidraw1"))).take());
  EXPECT_TRUE(CalibrationStamp(as(one)).isThere());
  EXPECT_TRUE(CalibrationStamp(as(one)).take());
  EXPECT_FALSE(CalibrationStamp(as(one)).take());
  EXPECT_FALSE(CalibrationStamp(as(one)).isThere());
}

// A program as another kind takes away what is there, and does not believe it.
TEST_F(Stamps, IsTakenByWhoeverOpensTheDevice) {
  const std::string one = node("hidraw0");
  EXPECT_TRUE(CalibrationStamp(as(one)).put());
  EXPECT_FALSE(CalibrationStamp(as(one, "another arm")).take());
  EXPECT_FALSE(CalibrationStamp(as(one)).isThere());
}

// What is put back is the stamp of the device that was opened, not of the one that is there now.
TEST_F(Stamps, IsOfTheDeviceThatWasThere) {
  const std::string one = node("hidraw0");
  const CalibrationStamp opened(as(one));
  std::filesystem::remove(one);
  const std::string keeper = node("keeps the inode");
  EXPECT_EQ(node("hidraw0"), one);
  EXPECT_TRUE(opened.put());
  EXPECT_FALSE(CalibrationStamp(as(one)).isThere());
}

TEST_F(Stamps, IsNoneWhereItCannotBeKept) {
  const std::string one = node("hidraw0");
  EXPECT_FALSE(CalibrationStamp(as((folder_.path() / "none").string())).put());
  for (const char* folder : {"", "relative", "/proc/none"}) {
    setenv("XDG_RUNTIME_DIR", folder, 1);
    EXPECT_FALSE(CalibrationStamp(as(one)).put()) << folder;
    EXPECT_FALSE(CalibrationStamp(as(one)).isThere()) << folder;
  }
  unsetenv("XDG_RUNTIME_DIR");
  EXPECT_FALSE(CalibrationStamp(as(one)).put());
  EXPECT_FALSE(CalibrationStamp(as(one)).isThere());
}

}  // namespace calibration_stamp_test
}  // namespace palpate
