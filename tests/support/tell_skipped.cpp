// SPDX-License-Identifier: Apache-2.0
#include "tests/support/tell_skipped.hpp"

#include <cstdlib>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

namespace palpate {
namespace {

class SkippedListener : public testing::EmptyTestEventListener {
 public:
  explicit SkippedListener(std::string file) : file_(std::move(file)) {}

 private:
  void OnTestEnd(const testing::TestInfo& test) override {
    const testing::TestResult& result = *test.result();
    if (!result.Skipped()) return;
    std::string line = std::string(test.test_suite_name()) + "." + test.name() + ":";
    for (int n = 0; n < result.total_part_count(); ++n)
      if (result.GetTestPartResult(n).skipped()) line += std::string(" ") + result.GetTestPartResult(n).message();
    for (char& c : line)
      if (c == '\n') c = ' ';
    std::ofstream(file_, std::ios::app) << line + "\n" << std::flush;  // in one piece: programs run side by side
  }

  std::string file_;
};

}  // namespace

void tellSkipped() {
  if (const char* const file = std::getenv("PALPATE_SKIPPED"))
    testing::UnitTest::GetInstance()->listeners().Append(new SkippedListener(file));
}

}  // namespace palpate
