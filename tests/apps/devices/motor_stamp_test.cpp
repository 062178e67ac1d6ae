// SPDX-License-Identifier: Apache-2.0
#include "apps/devices/motor_stamp.hpp"

#include <cstdlib>
#include <fstream>

#include <gtest/gtest.h>

#include "tests/apps/report/temporary_folder.hpp"

namespace palpate {
namespace motor_stamp_test {

class MotorStamps : public testing::Test {
 protected:
  MotorStamps() { setenv("XDG_STATE_HOME", folder_.path().c_str(), 1); }
  ~MotorStamps() override { unsetenv("XDG_STATE_HOME"); }
  static CheckedAs as(const std::string& kind = "arm", const std::string& place = "E0", double torque = 5) {
    return {.kind = kind, .usb = "1234:0006", .place = place, .values = {{"torque_a", torque}}};
  }
  TemporaryFolder folder_;
};

TEST_F(MotorStamps, HoldForOneDeviceAsOneKindWithItsValues) {
  EXPECT_FALSE(MotorStamp(as()).isThere());
  EXPECT_TRUE(MotorStamp(as()).put());
  EXPECT_TRUE(MotorStamp(as()).isThere());
  EXPECT_FALSE(MotorStamp(as("another arm")).isThere());
  EXPECT_FALSE(MotorStamp(as("arm", "E1")).isThere());
  EXPECT_FALSE(MotorStamp(as("arm", "E0", 6)).isThere());
  MotorStamp(as("another arm")).remove();
  EXPECT_TRUE(MotorStamp(as()).isThere());
  MotorStamp(as()).remove();
  EXPECT_FALSE(MotorStamp(as()).isThere());
}

// One of another form is none: it was made by a program that checked something else.
TEST_F(MotorStamps, AreNoneInAnotherForm) {
  EXPECT_TRUE(MotorStamp(as()).put());
  std::ofstream(MotorStamp(as()).file(), std::ios::app) << "more\n";
  EXPECT_FALSE(MotorStamp(as()).isThere());
  std::ofstream(MotorStamp(as()).file()) << "";
  EXPECT_FALSE(MotorStamp(as()).isThere());
}

TEST_F(MotorStamps, AreNoneWhereTheyCannotBeKept) {
  setenv("XDG_STATE_HOME", "/proc/none", 1);
  EXPECT_FALSE(MotorStamp(as()).put());
  EXPECT_FALSE(MotorStamp(as()).isThere());
}

// A serial number may hold anything.
TEST_F(MotorStamps, StayInTheirFolder) {
  const MotorStamp stamp(as("arm", "../../x/\n"));
  EXPECT_EQ(stamp.file().parent_path(), folder_.path() / "palpate" / "motors");
  EXPECT_TRUE(stamp.put());
  EXPECT_TRUE(stamp.isThere());
}

}  // namespace motor_stamp_test
}  // namespace palpate
