// SPDX-License-Identifier: Apache-2.0
// The servo's program with ceilings that it cannot read: whoever starts it, it says what is wrong with them, once, and
// ends. It never runs without them.
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "program_test.hpp"

namespace palpate {
namespace servo_program_test {

using testing::HasSubstr;
using testing::Not;

class ServoProgram : public ProgramTest {
 protected:
  // What stands in the place of servo.toml, what is said of it, and the status with which a servo ends.
  struct Ceilings {
    std::string name, reason;
    int status;
  };
  static const std::vector<Ceilings>& unreadable() {
    static const std::vector<Ceilings> all = {{"wrong", "it is no number", 2},
                                              {"nowhere", "the servo's ceilings cannot be opened", 3},
                                              {"ring", "nobody can say whether the servo's ceilings are there", 4}};
    return all;
  }

  // A user's folder of settings with these in it.
  [[nodiscard]] std::string settings(const std::string& name) const {
    const std::filesystem::path home = file("config-" + name), mine = home / "palpate";
    std::filesystem::create_directories(name == "ring" ? home : mine);
    if (name == "wrong") std::ofstream(mine / "servo.toml") << "max_force_N = \"strong\"\n";
    if (name == "nowhere") std::filesystem::create_symlink("none.toml", mine / "servo.toml");
    if (name == "ring") std::filesystem::create_symlink("palpate", mine);
    return home.string();
  }
  [[nodiscard]] Outcome start(const std::string& program, const Words& arguments, const std::string& name) const {
    return runPalpate({.arguments = arguments,
                       .program = program,
                       .folder = folder(),
                       .environment = {{"XDG_CONFIG_HOME", settings(name)},
                                       {"XDG_RUNTIME_DIR", folder().string()},
                                       {"XDG_STATE_HOME", folder().string()}}});
  }
};

TEST_F(ServoProgram, SaysWhatIsWrongWithItsCeilings) {
  for (const Ceilings& ceilings : unreadable()) {
    SCOPED_TRACE(ceilings.name);
    expectRefusal(start(PALPATE_PROGRAM, {"servo", "--connect", file("none.sock").string()}, ceilings.name),
                  "/palpate/servo.toml", ceilings.reason, ceilings.status);
    std::filesystem::remove_all(file("config-" + ceilings.name));
  }
}

// An engine that started it is told nothing of it: the channel is not read yet.
TEST_F(ServoProgram, SaysItWhereAnEngineStartsIt) {
  for (const Ceilings& ceilings : unreadable()) {
    SCOPED_TRACE(ceilings.name);
    expectRefusal(start(PALPATE_SERVO, {"--channel", "3"}, ceilings.name), "/palpate/servo.toml", ceilings.reason,
                  ceilings.status);
    std::filesystem::remove_all(file("config-" + ceilings.name));
  }
}

// It would end so again: nothing is started again and again, and the message is there once.
TEST_F(ServoProgram, IsNotStartedAgainBySupervisors) {
  for (const Ceilings& ceilings : unreadable()) {
    SCOPED_TRACE(ceilings.name);
    const Outcome outcome =
        start(PALPATE_PROGRAM,
              {"serve", "phantom:sphere?size=16", "--supervise", "--socket", file(ceilings.name + ".sock").string()},
              ceilings.name);
    EXPECT_FALSE(outcome.timed_out);
    EXPECT_EQ(outcome.status, 4) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(ceilings.reason));
    EXPECT_EQ(outcome.err.find(ceilings.reason), outcome.err.rfind(ceilings.reason)) << outcome.err;
    EXPECT_THAT(outcome.err,
                HasSubstr("servo: ended with status " + std::to_string(ceilings.status) + "; it would end so again"));
    EXPECT_THAT(outcome.err, Not(HasSubstr("started again")));
  }
}

}  // namespace servo_program_test
}  // namespace palpate
