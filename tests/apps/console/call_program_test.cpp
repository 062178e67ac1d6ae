// SPDX-License-Identifier: Apache-2.0
#include "apps/console/call_program.hpp"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>

#include "base/error.hpp"
#include "refusal.hpp"
#include "temporary_folder.hpp"

namespace palpate {
namespace call_program_test {

using testing::HasSubstr;

// A shell script as the program.
class CallProgram : public testing::Test {
 protected:
  [[nodiscard]] ProgramEnd run(const std::string& script, const std::vector<std::string>& words = {}) const {
    const std::filesystem::path program = folder_.path() / "program";
    std::ofstream(program) << "#!/bin/sh\n" << script << '\n';
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
    return callProgram({.words = words, .program = program.string(), .shows_messages = false});
  }
  [[nodiscard]] std::filesystem::path folder() const { return folder_.path(); }

 private:
  TemporaryFolder folder_;
};

TEST_F(CallProgram, GivesItsWordsAndKeepsItsMessages) {
  const ProgramEnd end = run("echo printed; echo \"$1, $2\" >&2", {"one word", "two"});
  EXPECT_EQ(end.failure, "");
  EXPECT_EQ(end.messages, "one word, two\n");
}

TEST_F(CallProgram, TellsHowItFailed) {
  const ProgramEnd refused = run("exit 3");
  EXPECT_EQ(refused.failure, "it ended with status 3");
  EXPECT_EQ(refused.status, 3);
  EXPECT_EQ(refused.signal, 0);
  const ProgramEnd killed = run("kill -9 $$");
  EXPECT_EQ(killed.failure, "it was ended by signal 9");
  EXPECT_EQ(killed.signal, 9);
  EXPECT_THAT(run("echo why >&2; exit 2").messages, HasSubstr("why"));
}

TEST_F(CallProgram, MessagesThatAreShownAreNotKept) {
  const ProgramEnd end = callProgram({.words = {"-c", "exit 4"}, .program = "/bin/sh"});
  EXPECT_EQ(end.failure, "it ended with status 4; its message is above");
  EXPECT_EQ(end.messages, "");
}

TEST_F(CallProgram, OneThatIsNotThereIsRefused) {
  EXPECT_THAT(refusalOf([] { (void)callProgram({.program = "/no/such/program"}); }, Error::Code::kIo),
              HasSubstr("no process can be started"));
}

}  // namespace call_program_test
}  // namespace palpate
