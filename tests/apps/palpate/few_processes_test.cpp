// SPDX-License-Identifier: Apache-2.0
// Too few processes for the program's threads and children: at every limit at which it starts, it works or says so.
#include <fcntl.h>
#include <unistd.h>

#include "program_test.hpp"
#include "tests/support/as_nobody.hpp"

namespace palpate {
namespace few_processes_test {

using testing::HasSubstr;

// Below this OpenVDB's log4cplus, which starts four threads before main(), ends the program itself.
constexpr std::uint64_t kLeast = 6;

TEST(FewProcesses, AreSaid) {
  // The limit counts all processes of a user: of nobody there are no others.
  if (geteuid() != 0) GTEST_SKIP() << "only the superuser can become nobody";
  {
    const AsNobody nobody;
    if (faccessat(AT_FDCWD, PALPATE_PROGRAM, X_OK, AT_EACCESS) != 0)
      GTEST_SKIP() << "the checkout lies where only the superuser may run the program: move it";
  }
  ASSERT_EQ(runPalpate({.arguments = {"--version"}, .folder = "/", .process_limit = 1000}).status, 0);
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
