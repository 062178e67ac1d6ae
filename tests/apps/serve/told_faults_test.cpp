// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/told_faults.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "servo/safety/faults.hpp"

namespace palpate {
namespace told_faults_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class Told : public testing::Test {
 protected:
  std::vector<std::string> look(std::uint32_t faults, std::int64_t now_ns) {
    std::vector<std::string> said;
    faults_.look(faults, now_ns, [&](const std::string& words) { said.push_back(words); });
    return said;
  }
  ToldFaults faults_;
};

constexpr std::uint32_t kUnstable = bit(ServoFault::kUnstable), kForceOff = bit(ServoFault::kForceOff);

TEST_F(Told, AsTheyBegin) {
  EXPECT_THAT(look(0, 1), IsEmpty());
  EXPECT_THAT(look(kUnstable, 2), ElementsAre(HasSubstr("the servo: unstable: ")));
  EXPECT_THAT(look(kUnstable, 3), IsEmpty());
  EXPECT_THAT(look(kUnstable | kForceOff, 4), ElementsAre(HasSubstr("the servo: force-off: ")));
}

TEST_F(Told, TheSameOnceInAWhile) {
  EXPECT_THAT(look(kUnstable, 1), testing::SizeIs(1));
  look(0, 2);
  EXPECT_THAT(look(kUnstable, ToldFaults::kPause_ns), IsEmpty());
  look(0, ToldFaults::kPause_ns);
  EXPECT_THAT(look(kUnstable, ToldFaults::kPause_ns + 1), testing::SizeIs(1));
}

// Windows that come late, limits and fast hands are ordinary.
TEST_F(Told, NotWhatIsOrdinary) {
  std::uint32_t ordinary = 0;
  for (const ServoFault fault : {ServoFault::kNoWindow, ServoFault::kStaleWindow, ServoFault::kBeyondWindow,
                                 ServoFault::kForceLimited, ServoFault::kSlewLimited, ServoFault::kOverrun})
    ordinary |= bit(fault);
  EXPECT_THAT(look(ordinary, 1), IsEmpty());
  for (const ServoFault fault : {ServoFault::kNonFiniteForce, ServoFault::kDeviceError, ServoFault::kStall,
                                 ServoFault::kUnstable, ServoFault::kForceOff, ServoFault::kCalibrationRefused})
    EXPECT_THAT(look(bit(fault), 2), testing::SizeIs(1)) << bit(fault);
}

}  // namespace told_faults_test
}  // namespace palpate
