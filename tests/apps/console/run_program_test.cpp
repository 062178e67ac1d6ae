// SPDX-License-Identifier: Apache-2.0
#include "apps/console/run_program.hpp"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>

#include "base/error.hpp"
#include "refusal.hpp"
#include "temporary_folder.hpp"

namespace palpate {
namespace run_program_test {

using testing::HasSubstr;

// A shell script as the program.
class RunProgram : public testing::Test {
 protected:
  [[nodiscard]] ProgramEnd run(const std::string& script, const std::vector<std::string>& words = {}) const {
    const std::filesystem::path program = folder_.path() / "program";
    std::ofstream(program) << "#!/bin/sh\n" << script << '\n';
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
    return runProgram({.words = words, .program = program.string(), .shows_messages = false});
  }
  [[nodiscard]] std::filesystem::path folder() const { return folder_.path(); }

 private:
  TemporaryFolder folder_;
};

TEST_F(RunProgram, GivesItsWordsAndKeepsItsMessages) {
  const ProgramEnd end = run("echo printed; echo \"$1, $2\" >&2", {"one word", "two"});
  EXPECT_EQ(end.failure, "");
  EXPECT_EQ(end.messages, "one word, two\n");
}

TEST_F(RunProgram, TellsHowItFailed) {
  EXPECT_EQ(run("exit 3").failure, "it ended with status 3");
  EXPECT_EQ(run("kill -9 $$").failure, "it was ended by signal 9");
  EXPECT_THAT(run("echo why >&2; exit 2").messages, HasSubstr("why"));
}

TEST_F(RunProgram, MessagesThatAreShownAreNotKept) {
  const ProgramEnd end = runProgram({.words = {"-c", "exit 4"}, .program = "/bin/sh"});
  EXPECT_EQ(end.failure, "it ended with status 4; its message is above");
  EXPECT_EQ(end.messages, "");
}

TEST_F(RunProgram, OneThatIsNotThereIsRefused) {
  EXPECT_THAT(refusalOf([] { (void)runProgram({.program = "/no/such/program"}); }, Error::Code::kIo),
              HasSubstr("no process can be started"));
}

}  // namespace run_program_test
}  // namespace palpate
