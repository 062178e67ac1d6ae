// SPDX-License-Identifier: Apache-2.0
#include "engine/journal/acknowledged_file.hpp"

#include <cstdlib>
#include <limits>

#include <gtest/gtest.h>

#include "journal_samples.hpp"

namespace palpate {
namespace acknowledged_file_test {

// Twenty digits and an end of line, however small the number is: whoever reads meanwhile sees no half of one.
TEST(AcknowledgedFile, HoldsTheNewestNumber) {
  const TemporaryFolder folder;
  const std::string file = folder.path() / "newest";
  std::ofstream(file) << "what was there before, which is longer than a number";
  const AcknowledgedFile acknowledged(file.c_str());
  EXPECT_EQ(contentsOf(file), "");
  acknowledged.set(42);
  EXPECT_EQ(contentsOf(file), "00000000000000000042\n");
  acknowledged.set(std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(contentsOf(file), "18446744073709551615\n");
  acknowledged.set(7);
  EXPECT_EQ(contentsOf(file), "00000000000000000007\n");
}

TEST(AcknowledgedFile, ThatCannotBeMadeIsLeftOut) {
  const TemporaryFolder folder;
  const AcknowledgedFile none((folder.path() / "no" / "newest").c_str());
  none.set(1);
  EXPECT_EQ(folder.files(), 0);
}

TEST(WatchedJournal, TellsTheFileThatTheEnvironmentNames) {
  const TemporaryFolder folder;
  const std::string file = folder.path() / "newest";
  unsetenv("PALPATE_ACKNOWLEDGED");
  EXPECT_FALSE(watchedJournal().on_acknowledged);
  setenv("PALPATE_ACKNOWLEDGED", file.c_str(), 1);
  const JournalOptions options = watchedJournal();
  unsetenv("PALPATE_ACKNOWLEDGED");
  ASSERT_TRUE(options.on_acknowledged);
  options.on_acknowledged(5);
  EXPECT_EQ(contentsOf(file), "00000000000000000005\n");
}

}  // namespace acknowledged_file_test
}  // namespace palpate
