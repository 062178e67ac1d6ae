// SPDX-License-Identifier: Apache-2.0
// Records made up: approach 0 to 1 s, press to 2 s, slide to 4 s, retreat to 5 s.
#include "apps/report/path_outcome.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace path_outcome_test {

constexpr double kRate_hz = 1000;
const std::vector<PathPhase> kPhases = {{"approach", 0, 1}, {"press", 1, 2}, {"slide", 2, 4}, {"retreat", 4, 5}};

// In contact from 1 s to 4.3 s.
std::vector<TickRecord> goodRun() {
  std::vector<TickRecord> records(5000);
  for (std::size_t i = 0; i < records.size(); ++i) {
    records[i].tick = static_cast<std::int64_t>(i);
    records[i].time_s = static_cast<double>(i) / kRate_hz;
    records[i].in_contact = i >= 1000 && i < 4300;
  }
  return records;
}

void setContact(std::vector<TickRecord>& records, std::size_t begin, std::size_t end, bool in_contact) {
  for (std::size_t i = begin; i < end; ++i) records[i].in_contact = in_contact;
}

TEST(PathOutcome, OfAGoodRunIsNothing) {
  const PathOutcome outcome = pathOutcome(goodRun(), kPhases, kRate_hz);
  EXPECT_EQ(outcome.lost_s, 0);
  EXPECT_EQ(outcome.retreat_touches, 0);
  EXPECT_FALSE(outcome.ends_in_contact);
  EXPECT_EQ(pathClause(outcome), "");
}

TEST(PathOutcome, CountsTheTimeOffTheSurfaceInTheSlideOnly) {
  std::vector<TickRecord> records = goodRun();
  setContact(records, 1500, 1600, false);  // in the press
  setContact(records, 2000, 2050, false);
  setContact(records, 3990, 4003, false);  // ten ticks of it in the slide
  EXPECT_NEAR(pathOutcome(records, kPhases, kRate_hz).lost_s, 0.06, 1e-12);
  EXPECT_EQ(pathClause(pathOutcome(records, kPhases, kRate_hz)), "; it left the surface for 0.06 s of the slide");
  // Grid points that were left out belong to the tick before them.
  records.erase(records.begin() + 2010, records.begin() + 2040);
  EXPECT_NEAR(pathOutcome(records, kPhases, kRate_hz).lost_s, 0.06, 1e-12);
}

// The verdict says already that nothing was touched.
TEST(PathOutcome, NothingIsLostThatNeverWas) {
  std::vector<TickRecord> records = goodRun();
  setContact(records, 0, 5000, false);
  EXPECT_EQ(pathOutcome(records, kPhases, kRate_hz).lost_s, 0);
  setContact(records, 3000, 3500, true);
  EXPECT_NEAR(pathOutcome(records, kPhases, kRate_hz).lost_s, 0.5, 1e-12);
}

TEST(PathOutcome, SeesARetreatThatTouchesAgainOrStays) {
  std::vector<TickRecord> records = goodRun();
  setContact(records, 4400, 4450, true);
  PathOutcome outcome = pathOutcome(records, kPhases, kRate_hz);
  EXPECT_EQ(outcome.retreat_touches, 1);
  EXPECT_FALSE(outcome.ends_in_contact);
  EXPECT_EQ(pathClause(outcome), "; the retreat touched the object again");
  setContact(records, 4300, 5000, true);
  outcome = pathOutcome(records, kPhases, kRate_hz);
  EXPECT_EQ(outcome.retreat_touches, 0);
  EXPECT_TRUE(outcome.ends_in_contact);
  EXPECT_EQ(pathClause(outcome), "; the retreat ended in contact");
}

// A contact that ends in noise comes and goes for a tick or two.
TEST(PathOutcome, ShortGapsAreOneTouch) {
  std::vector<TickRecord> records = goodRun();
  setContact(records, 4303, 4304, true);
  EXPECT_EQ(pathOutcome(records, kPhases, kRate_hz).retreat_touches, 0);
  setContact(records, 4309, 4310, true);
  EXPECT_EQ(pathOutcome(records, kPhases, kRate_hz).retreat_touches, 1);
}

TEST(PathOutcome, OfAPathFromAFileOrARunThatWasStoppedIsNothing) {
  std::vector<TickRecord> records = goodRun();
  records.back().in_contact = true;
  EXPECT_FALSE(pathOutcome(records, {}, kRate_hz).ends_in_contact);
  records = goodRun();
  records.resize(3000);
  EXPECT_FALSE(pathOutcome(records, kPhases, kRate_hz).ends_in_contact);
  EXPECT_EQ(pathClause(pathOutcome({}, kPhases, kRate_hz)), "");
  // The last tick of 5 s begins at 4.999 s; one less, and the end of the retreat is missing.
  records = goodRun();
  setContact(records, 4990, 5000, true);
  EXPECT_TRUE(pathOutcome(records, kPhases, kRate_hz).ends_in_contact);
  records.pop_back();
  EXPECT_FALSE(pathOutcome(records, kPhases, kRate_hz).ends_in_contact);
}

}  // namespace path_outcome_test
}  // namespace palpate
