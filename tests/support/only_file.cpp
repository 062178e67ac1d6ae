// SPDX-License-Identifier: Apache-2.0
#include "tests/support/only_file.hpp"

#include <iostream>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

namespace palpate {
namespace {

std::string filterFor(std::string_view file) {
  const testing::UnitTest& all = *testing::UnitTest::GetInstance();
  const std::string end = "/" + std::string(file);
  std::string filter;
  for (int s = 0; s < all.total_test_suite_count(); ++s) {
    const testing::TestSuite& suite = *all.GetTestSuite(s);
    for (int t = 0; t < suite.total_test_count(); ++t) {
      const testing::TestInfo& test = *suite.GetTestInfo(t);
      if (std::string_view(test.file()).ends_with(end))
        filter += (filter.empty() ? "" : ":") + std::string(suite.name()) + "." + test.name();
    }
  }
  return filter;
}

}  // namespace

bool takeOnlyFile(int argc, char** argv) {
  if (argc < 3 || std::string_view(argv[1]) != "--only") return true;
  if (testing::GTEST_FLAG(filter) != "*") return true;  // somebody wants less; so does a death test's child
  testing::GTEST_FLAG(filter) = filterFor(argv[2]);
  if (!testing::GTEST_FLAG(filter).empty()) return true;
  std::cerr << "no test of this program is in a file " << argv[2] << "\n";
  return false;
}

}  // namespace palpate
