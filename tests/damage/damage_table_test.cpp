// SPDX-License-Identifier: Apache-2.0
// Files of every format, damaged: none crashes or hangs or fills the memory, nothing damaged is accepted where the
// format has a checksum or a length, and docs/volumes.md says what each format can tell. Some 1,900 files, each read in
// a process of its own, take some 15 s. `damaged_files` does the same with more of them.
#include <gtest/gtest.h>

#include "tests/damage/campaign.hpp"
#include "tests/engine/files/files.hpp"
#include "tests/support/long_run.hpp"

namespace palpate::damage {
namespace damage_table_test {

class Campaign : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    Plan plan;
    plan.per_cell = 8;
    plan.many = isLongRun() ? 12 : 4;  // these are not in the table
    result_ = run(plan);
  }
  inline static Result result_;
};

TEST_F(Campaign, NothingFails) {
  for (const std::string& failure : result_.failures) ADD_FAILURE() << failure;
  EXPECT_GT(result_.files, 1000U);
}

// Shows that the judge can tell damage at all: each of these kinds passes in some format. So a promise that is kept
// means something.
TEST_F(Campaign, DamageThatNoFormatTellsIsSeenToPass) {
  for (const Damage damage : {Damage::kValueByte, Damage::kHeaderByte, Damage::kHeaderValue, Damage::kLineLost}) {
    std::size_t changed = 0;
    for (const auto& [key, cell] : result_.cells) changed += key.second == damage ? cell.changed : 0;
    EXPECT_GT(changed, 0U) << nameOf(damage);
  }
}

TEST_F(Campaign, TheTableIsInTheDocumentation) {
  const std::string page = readFile(PALPATE_DOCS "/volumes.md");
  EXPECT_NE(page.find(table(result_)), std::string::npos) << "docs/volumes.md must hold:\n" << table(result_);
}

// Nobody could detect damage that changes nothing.
TEST(WholeFiles, AreDamagedInEveryWay) {
  std::mt19937_64 random(1);
  for (const WholeFile& file : wholeFiles()) {
    const std::string whole = "key" + std::string(1, file.separator) + "1 2 3\nother\n" + std::string(2000, 'v');
    for (const Damage damage : kDamages) {
      if (!applies(damage, file)) continue;
      EXPECT_NE(damaged(whole, damage, file, random), whole) << file.name;
    }
  }
}

}  // namespace damage_table_test
}  // namespace palpate::damage
