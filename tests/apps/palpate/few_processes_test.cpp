// SPDX-License-Identifier: Apache-2.0
// Too few processes for the program's threads and children: at every limit at which it starts, it works or says so.
#include <unistd.h>

#include "program_test.hpp"

namespace palpate {
namespace few_processes_test {

using testing::HasSubstr;

// Below this OpenVDB's log4cplus, which starts four threads before main(), ends the program itself.
constexpr std::uint64_t kLeast = 6;

TEST(FewProcesses, AreSaid) {
  // The limit counts all processes of a user: of nobody there are no others.
  if (geteuid() != 0) GTEST_SKIP() << "only the superuser can become nobody";
  const Command version{.arguments = {"--version"}, .folder = "/", .process_limit = 1000};
  if (runPalpate(version).status != 0) GTEST_SKIP() << "nobody may not run the program where it lies";
  int refusals = 0;
  bool works = false;
  for (std::uint64_t limit = kLeast; limit < kLeast + 30 && !works; ++limit) {
    const Outcome outcome =
        runPalpate({.arguments = {"info", "phantom:sphere?size=32"}, .folder = "/", .process_limit = limit});
    EXPECT_EQ(outcome.signal, 0) << limit << "\n" << outcome.err;
    works = outcome.status == 0;
    if (works) break;
    expectRefusal(outcome, "", "ulimit -u", 4);
    ++refusals;
  }
  EXPECT_TRUE(works);
  EXPECT_GT(refusals, 0);
}

}  // namespace few_processes_test
}  // namespace palpate
