// SPDX-License-Identifier: Apache-2.0
#include "apps/sculpt/force_words.hpp"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "servo/devices/force_off.hpp"
#include "servo/safety/faults.hpp"

namespace palpate {
namespace force_words_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TickRecord tick() {
  TickRecord record;
  record.tick = 7;
  record.force_W[0] = 0.3;
  record.force_W[2] = -0.4;
  record.depth_m = 1e-3;
  record.in_contact = true;
  record.density = 500;
  return record;
}

TEST(ForceWords, TellWhatIsFelt) {
  const ForceWords words = forceWords(tick(), "", 300);
  EXPECT_EQ(words.state, "0.50 N, 1.00 mm deep");
  EXPECT_THAT(words.reasons, IsEmpty());
}

TEST(ForceWords, TellWhyThereIsNone) {
  TickRecord record = tick();
  record.in_contact = false;
  EXPECT_THAT(forceWords(record, "", 300).reasons, ElementsAre(HasSubstr("take it out once")));
  record.density = 300;
  EXPECT_THAT(forceWords(record, "", 300).reasons, ElementsAre(HasSubstr("outside the object")));
  EXPECT_THAT(forceWords(record, "", 300).reasons, ElementsAre(HasSubstr("press the left button")));
  EXPECT_THAT(forceWords(record, "", 300, ForceOff::kNone).reasons, ElementsAre(HasSubstr("move the device to it")));
  for (const float unknown : {std::numeric_limits<float>::quiet_NaN(), -std::numeric_limits<float>::infinity()}) {
    record.density = unknown;  // beyond the window, or beyond the volume
    EXPECT_THAT(forceWords(record, "", 300).reasons, ElementsAre(HasSubstr("outside the volume")));
  }
  EXPECT_EQ(forceWords(record, "", 300).state, "no contact");
  record.tick = -1;
  EXPECT_THAT(forceWords(record, "", 300).state, HasSubstr("starting"));
  EXPECT_THAT(forceWords(tick(), "it has ended: open the volume again", 300).state, HasSubstr("not running"));
  EXPECT_THAT(forceWords(tick(), "it has ended: open the volume again", 300).reasons,
              ElementsAre(HasSubstr("open the volume again")));
}

// Of a device that a person holds, first of all, in contact too, with what to do; and no guess beside it is lost.
TEST(ForceWords, TellWhyADeviceExertsNone) {
  for (const ForceOff why : {ForceOff::kInputOnly, ForceOff::kNoCurrentLimit, ForceOff::kUncalibrated,
                             ForceOff::kLimitZero, ForceOff::kDisconnected}) {
    TickRecord record = tick();
    const auto off = testing::AllOf(HasSubstr("forces are off because " + std::string(wordsOf(why).reason)),
                                    HasSubstr(std::string(wordsOf(why).remedy)));
    EXPECT_THAT(forceWords(record, "", 300, why).reasons, ElementsAre(off));
    record.faults = bit(ServoFault::kStaleWindow);
    EXPECT_THAT(forceWords(record, "", 300, why).reasons, ElementsAre(off, HasSubstr("in time")));
  }
  EXPECT_THAT(forceWords(tick(), "", 300, ForceOff::kNone).reasons, IsEmpty());
}

// Each fault in the words of the table, with its remedy.
TEST(ForceWords, TellEveryFault) {
  for (const FaultText& fault : faultTable()) {
    TickRecord record = tick();
    record.faults = bit(fault.fault);
    EXPECT_THAT(forceWords(record, "", 300).reasons,
                ElementsAre(testing::AllOf(HasSubstr(fault.text), HasSubstr(fault.remedy))));
    record.in_contact = false;
    EXPECT_EQ(forceWords(record, "", 300).reasons.size(), 1U);  // nothing else is guessed
  }
}

}  // namespace force_words_test
}  // namespace palpate
