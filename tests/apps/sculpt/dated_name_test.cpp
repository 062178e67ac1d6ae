// SPDX-License-Identifier: Apache-2.0
// Names of files that nobody named.
#include "apps/sculpt/dated_name.hpp"

#include <fstream>

#include <gtest/gtest.h>

#include "temporary_folder.hpp"

namespace palpate {
namespace dated_name_test {

TEST(DatedName, IsOfTheMomentAndOfNoFileThatIsThere) {
  const TemporaryFolder folder;
  std::tm moment{};
  moment.tm_year = 126;
  moment.tm_mon = 10;
  moment.tm_mday = 3;
  moment.tm_hour = 9;
  moment.tm_min = 5;
  moment.tm_sec = 7;
  moment.tm_isdst = -1;
  const std::time_t now = std::mktime(&moment);
  const auto name = [&] { return datedName(folder.path(), "palpate", ".png", now); };
  EXPECT_EQ(name(), folder.path() / "palpate-20261103-090507.png");
  std::ofstream(name()) << 1;
  EXPECT_EQ(name(), folder.path() / "palpate-20261103-090507-2.png");
  std::ofstream(name()) << 1;
  EXPECT_EQ(name(), folder.path() / "palpate-20261103-090507-3.png");
  EXPECT_EQ(datedName(".", "a", ".csv", now), "a-20261103-090507.csv");
}

}  // namespace dated_name_test
}  // namespace palpate
