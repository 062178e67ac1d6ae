// SPDX-License-Identifier: Apache-2.0
// Shell scripts as the programs. They signal the supervisor, which is the test itself, by $PPID, and wait for each
// other by files. No time is asserted: only what is told, in which order and how often, and which processes are left.
#include "apps/supervise/supervisor.hpp"

#include <cerrno>
#include <csignal>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/wait.h>

#include "apps/console/interrupt.hpp"
#include "open_descriptors.hpp"
#include "refusal.hpp"
#include "temporary_folder.hpp"
#include "tests/apps/console/in_child.hpp"
#include "tests/apps/supervise/appears.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace supervisor_test {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;
using testing::UnorderedElementsAre;

constexpr double kLongPatience_s = 1000;  // more than a test may take: whatever is killed fails the test
constexpr double kNoPatience_s = 0.01;

// Parts of scripts, which run in the test's folder. None goes on for ever, should the test fail.
constexpr const char* kGoesOn = "n=0; while [ $((n += 1)) -lt 3000 ]; do sleep 0.01; done";
std::string waitsFor(const std::string& file) {
  return "n=0; while [ ! -e " + file + " ] && [ $((n += 1)) -lt 3000 ]; do sleep 0.01; done; ";
}
std::string saysAt(const std::string& signal, const std::string& then) {
  return "trap 'echo " + signal + " >> said; " + then + "' " + signal + "; ";
}

class Supervisor : public testing::Test {
 protected:
  Supervisor() {
    settings.patience_s = kLongPatience_s;
    settings.restarts.first_wait_s = 0.01;
    settings.tell = [this](const std::string& line) { lines.push_back(line); };
  }
  ~Supervisor() override {
    EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1) << "a child or a zombie is left";
    EXPECT_EQ(errno, ECHILD);
  }

  [[nodiscard]] std::filesystem::path file(const std::string& name) const { return folder_.path() / name; }
  [[nodiscard]] std::string said() const { return contentsOf(file("said")); }
  // The script notes first that it runs; see runs().
  [[nodiscard]] SupervisedCommand command(const std::string& name, const std::string& script,
                                          bool essential = false) const {
    return {.name = name,
            .argv = {"sh", "-c",
                     fmt::format("exec 2> /dev/null; cd {}; echo $$ >> {}.runs; {}", folder_.path().string(), name,
                                 script)},
            .essential = essential};
  }
  [[nodiscard]] std::vector<pid_t> runs(const std::string& name) const {
    std::ifstream in(file(name + ".runs"));
    return {std::istream_iterator<pid_t>(in), {}};
  }
  // A script that does one thing on its first run, another on its second, and so on.
  [[nodiscard]] static std::string inTurn(const std::string& name, const std::vector<std::string>& scripts) {
    std::string all = "case $(wc -l < " + name + ".runs) in ";
    for (std::size_t n = 0; n < scripts.size(); ++n) all += fmt::format("{}) {};; ", n + 1, scripts[n]);
    return all + "esac";
  }

  SupervisorSettings settings;
  std::vector<std::string> lines;

 private:
  TemporaryFolder folder_;
};

TEST_F(Supervisor, StartsAgainWhatDied) {
  const SupervisionEnd end = supervise(
      {command("servo", inTurn("servo", {"exit 3", "kill -KILL $$", "kill -SEGV $$", "exit 0"}), true)}, settings);
  EXPECT_THAT(lines, ElementsAre("servo: ended with status 3; it is started again at once",
                                 "servo: killed by signal 9 (SIGKILL); it is started again in 0.01 s",
                                 "servo: killed by signal 11 (SIGSEGV); it is started again in 0.02 s",
                                 "servo: ended with status 0; so all is ended"));
  EXPECT_EQ(end.restarts, 3);
  EXPECT_EQ(end.signal, 0);
  EXPECT_EQ(end.killed, 0);
  EXPECT_EQ(runs("servo").size(), 4U);
}

// It would end so again and again, as for a file that is not there.
TEST_F(Supervisor, WhatIsHopelessIsNotStartedAgain) {
  SupervisedCommand engine =
      command("engine", waitsFor("ready") + inTurn("engine", {"exit 1", "exit 2", "exit 0"}), true);
  engine.hopeless = {2, 3};
  const std::string refusal = refusalOf(
      [&] {
        supervise({command("servo", saysAt("TERM", "exit 0") + "touch ready; " + kGoesOn), engine}, settings);
      },
      Error::Code::kIo);
  EXPECT_THAT(refusal, HasSubstr("engine: ended with status 2, as it would again"));
  EXPECT_THAT(lines, ElementsAre("engine: ended with status 1; it is started again at once",
                                 "engine: ended with status 2; it would end so again"));
  EXPECT_EQ(runs("engine").size(), 2U);
  EXPECT_EQ(said(), "TERM\n");  // the other one was told to end
}

TEST_F(Supervisor, TheOthersGoOnWhenOneDies) {
  const SupervisionEnd end =
      supervise({command("servo", saysAt("TERM", "exit 0") + "touch ready; " + kGoesOn),
                 command("engine", waitsFor("ready") + inTurn("engine", {"exit 1", "exit 0"}), true)},
                settings);
  EXPECT_EQ(end.restarts, 1);
  EXPECT_EQ(runs("servo").size(), 1U);
  EXPECT_EQ(runs("engine").size(), 2U);
}

TEST_F(Supervisor, EndsAllInGoodOrderWhenTheEssentialOneIsDone) {
  const SupervisionEnd end = supervise({command("servo", saysAt("TERM", "exit 0") + "touch ready; " + kGoesOn),
                                        command("engine", waitsFor("ready") + "exit 0", true)},
                                       settings);
  EXPECT_EQ(said(), "TERM\n");
  EXPECT_EQ(end.signal, 0);
  EXPECT_EQ(end.restarts, 0);
  EXPECT_EQ(end.killed, 0);
  EXPECT_THAT(lines, ElementsAre("engine: ended with status 0; so all is ended"));
}

TEST_F(Supervisor, WhatIsDoneIsNotStartedAgain) {
  const SupervisionEnd end = supervise({command("a", "exit 0"), command("b", "exit 0")}, settings);
  EXPECT_EQ(end.restarts, 0);
  EXPECT_EQ(end.signal, 0);
  EXPECT_THAT(lines, UnorderedElementsAre("a: ended with status 0; it is not started again",
                                          "b: ended with status 0; it is not started again"));
}

TEST_F(Supervisor, PassesARequestToStopOnAsSigterm) {
  for (const auto& [signal, word] : {std::pair(SIGTERM, "TERM"), std::pair(SIGINT, "INT")}) {
    std::filesystem::remove(file("said"));
    std::filesystem::remove(file("ready"));
    const std::string listens = saysAt("TERM", "exit 0") + saysAt("INT", "exit 0");
    const SupervisionEnd end =
        supervise({command("servo", listens + "touch ready; " + kGoesOn),
                   command("engine", listens + waitsFor("ready") + "kill -" + word + " $PPID; " + kGoesOn, true)},
                  settings);
    EXPECT_EQ(said(), "TERM\nTERM\n");
    EXPECT_EQ(end.signal, signal);
    EXPECT_EQ(end.restarts, 0);
    EXPECT_EQ(end.killed, 0);
    EXPECT_THAT(lines, ElementsAre());
  }
}

TEST_F(Supervisor, WhatWaitsForItsStartIsNotStartedAnyMore) {
  settings.restarts.first_wait_s = settings.restarts.most_wait_s = kLongPatience_s;
  const SupervisionEnd end =
      supervise({command("servo", inTurn("servo", {"exit 1", "touch dying; exit 1"})),
                 command("engine", waitsFor("dying") + "sleep 0.1; kill -TERM $PPID; " + kGoesOn, true)},
                settings);
  EXPECT_EQ(end.signal, SIGTERM);
  EXPECT_EQ(runs("servo").size(), 2U);
}

TEST_F(Supervisor, PassesAHangUpOnAndGoesOn) {
  const SupervisionEnd end =
      supervise({command("servo", saysAt("HUP", "touch told") + saysAt("TERM", "exit 0") + "touch ready; " + kGoesOn),
                 command("engine", "trap '' HUP; " + waitsFor("ready") + "kill -HUP $PPID; " + waitsFor("told"), true)},
                settings);
  EXPECT_EQ(said(), "HUP\nTERM\n");
  EXPECT_EQ(end.signal, 0);
  EXPECT_EQ(end.restarts, 0);
}

TEST_F(Supervisor, GivesUpWhatDiesAgainAndAgain) {
  settings.restarts.short_life_s = settings.restarts.short_lives_within_s = kLongPatience_s;
  const std::string refusal = refusalOf(
      [&] {
        supervise({command("servo", saysAt("TERM", "exit 0") + "touch ready; " + kGoesOn),
                   command("engine", waitsFor("ready") + "exit 2", true)},
                  settings);
      },
      Error::Code::kIo);
  EXPECT_THAT(refusal, AllOf(HasSubstr("engine: it died 5 times within 1000 s, the last time: ended with status 2; "),
                             HasSubstr("alone: sh -c ")));
  EXPECT_EQ(runs("engine").size(), 5U);
  EXPECT_EQ(runs("servo").size(), 1U);
  EXPECT_EQ(said(), "TERM\n");  // in good order
  ASSERT_EQ(lines.size(), 5U);
  EXPECT_EQ(lines.back(), "engine: ended with status 2; it is given up");
}

TEST_F(Supervisor, KillsWhatDoesNotEnd) {
  SupervisedCommand servo = command("servo", "trap '' TERM; touch ready; " + std::string(kGoesOn));
  servo.patience_s = kNoPatience_s;  // before it is killed; its death is waited for with the settings' patience
  const SupervisionEnd end = supervise({servo, command("engine", waitsFor("ready") + "exit 0", true)}, settings);
  EXPECT_EQ(end.killed, 1);
  EXPECT_THAT(lines, ElementsAre("engine: ended with status 0; so all is ended",
                                 "servo: still there 0.01 s after SIGTERM; it is killed"));
  ASSERT_EQ(runs("servo").size(), 1U);
  EXPECT_EQ(kill(runs("servo")[0], 0), -1);
}

// One that writes a large file is waited for, though another one is not.
TEST_F(Supervisor, WaitsForEachAsLongAsItMay) {
  settings.patience_s = kNoPatience_s;
  SupervisedCommand engine = command("engine", saysAt("TERM", "sleep 0.3; exit 0") + "touch ready; " + kGoesOn);
  engine.patience_s = kLongPatience_s;
  const SupervisionEnd end = supervise({command("servo", std::string("trap '' TERM; touch deaf; ") + kGoesOn), engine,
                                        command("first", waitsFor("deaf") + waitsFor("ready") + "exit 0", true)},
                                       settings);
  EXPECT_EQ(end.killed, 1);
  EXPECT_EQ(said(), "TERM\n");
}

TEST_F(Supervisor, EndsWhatWasStopped) {
  const SupervisionEnd end =
      supervise({command("servo", "touch ready; kill -STOP $$; " + std::string(kGoesOn)),
                 command("engine",
                         waitsFor("ready") + "n=0; while ! grep -q '(stopped)' /proc/$(cat servo.runs)/status && [ "
                                             "$((n += 1)) -lt 3000 ]; do sleep 0.01; done",
                         true)},
                settings);
  EXPECT_EQ(end.killed, 0);
}

TEST_F(Supervisor, TellsATroubledEnd) {
  supervise({command("servo", saysAt("TERM", "exit 6") + "touch ready; " + kGoesOn),
             command("engine", waitsFor("ready") + "exit 0", true)},
            settings);
  EXPECT_THAT(lines, ElementsAre("engine: ended with status 0; so all is ended",
                                 "servo: ended with status 6 when it was told to end"));
}

TEST_F(Supervisor, EndsWhatADeadOneLeft) {
  const std::string leaves = "(trap 'echo left >> said; exit' TERM; touch ready; " + std::string(kGoesOn) + ") & ";
  supervise(
      {command("engine", inTurn("engine", {leaves + waitsFor("ready") + "kill -KILL $$", kGoesOn}), true),
       command("watch",
               "n=0; while ! grep -qs left said && [ $((n += 1)) -lt 3000 ]; do sleep 0.01; done; kill -TERM $PPID; " +
                   std::string(kGoesOn))},
      settings);
  EXPECT_THAT(said(), StartsWith("left\n"));
}

TEST_F(Supervisor, RefusesAMissingProgramAndEndsWhatWasStarted) {
  SupervisedCommand missing{.name = "engine", .argv = {"/no/such/palpate"}, .essential = true};
  EXPECT_THAT(
      refusalOf(
          [&] {
            supervise({command("servo", kGoesOn), missing}, settings);
          },
          Error::Code::kNotFound),
      AllOf(HasSubstr("/no/such/palpate: "), HasSubstr("engine cannot be started; give the path of a program")));
  EXPECT_THAT(lines, ElementsAre());
}

TEST_F(Supervisor, TriesAgainWhereAProgramIsAwayForAWhile) {
  std::ofstream(file("program")) << "#!/bin/sh\nmv " << file("program").string() << ' ' << file("away").string()
                                 << "; exit 3\n";
  std::filesystem::permissions(file("program"), std::filesystem::perms::owner_all);
  settings.tell = [this](const std::string& line) {
    lines.push_back(line);
    if (line.find("not started") != line.npos) {
      std::ofstream(file("new")) << "#!/bin/sh\nexit 0\n";
      std::filesystem::permissions(file("new"), std::filesystem::perms::owner_all);
      std::filesystem::rename(file("new"), file("program"));
    }
  };
  const SupervisionEnd end =
      supervise({{.name = "engine", .argv = {file("program").string()}, .essential = true}}, settings);
  EXPECT_EQ(end.restarts, 1);
  EXPECT_THAT(lines, ElementsAre("engine: ended with status 3; it is started again at once",
                                 AllOf(HasSubstr("engine: not started (there is no such program"),
                                       HasSubstr("; it is started again in 0.01 s")),
                                 "engine: ended with status 0; so all is ended"));
}

TEST_F(Supervisor, GoesOnWhereALineCannotBeTold) {
  settings.tell = [](const std::string&) { throw std::runtime_error("a full disk"); };
  EXPECT_EQ(supervise({command("engine", inTurn("engine", {"exit 3", "exit 0"}), true)}, settings).restarts, 1);
}

TEST_F(Supervisor, ByDefaultTellsTheUser) {
  const Ended ended = inChild([this] {
    settings.tell = {};
    supervise({command("engine", "exit 0", true)}, settings);
  });
  EXPECT_EQ(ended.err, "palpate: engine: ended with status 0; so all is ended\n");
}

TEST_F(Supervisor, RefusesCommandsThatAreNone) {
  EXPECT_THAT(refusalOf([&] { supervise({}, settings); }), HasSubstr("no command is given"));
  EXPECT_THAT(refusalOf([&] { supervise({{.name = "", .argv = {"true"}}}, settings); }), HasSubstr("has no name"));
  EXPECT_THAT(refusalOf([&] { supervise({{.name = "engine", .argv = {}}}, settings); }),
              HasSubstr("engine: no program is given"));
  settings.patience_s = -1;
  EXPECT_THAT(refusalOf([&] { supervise({command("engine", "exit 0")}, settings); }), HasSubstr("patience: -1"));
}

TEST_F(Supervisor, LeavesNoDescriptorOpen) {
  supervise({command("engine", "exit 0", true)}, settings);  // the inbox keeps one for good
  const long open_before = openDescriptors();
  supervise({command("engine", inTurn("engine", {"", "exit 3", "exit 0"}), true)}, settings);
  EXPECT_EQ(openDescriptors(), open_before);
}

TEST_F(Supervisor, TellsItsChildrenByItsOwnDeath) {
  const Ended ended = inChild(
      [this] {
        supervise({command("servo", saysAt("TERM", "touch ended; exit 0") + "touch ready; " + kGoesOn)}, settings);
      },
      [this](pid_t supervisor) {
        EXPECT_TRUE(appears(file("ready")));
        kill(supervisor, SIGKILL);
        EXPECT_TRUE(appears(file("ended")));
      });
  EXPECT_EQ(ended.signal, SIGKILL);
  EXPECT_EQ(said(), "TERM\n");
}

// Beside the program's own handling of signals, whose thread would end the process 150 ms after a request.
TEST_F(Supervisor, WaitsForItsChildrenThoughTheProgramCatchesInterrupts) {
  const Ended ended = inChild([this] {
    catchInterrupts();
    const SupervisionEnd end = supervise(
        {command("servo", saysAt("TERM", "sleep 0.4; echo rest >> said; exit 0") + "kill -TERM $PPID; " + kGoesOn)},
        settings);
    _exit(end.signal == SIGTERM && end.killed == 0 && !interrupted() ? 0 : 1);
  });
  EXPECT_EQ(ended.status, 0);
  EXPECT_EQ(said(), "TERM\nrest\n");
}

TEST_F(Supervisor, StartsNothingAfterARequestToStop) {
  const Ended ended = inChild([this] {
    catchInterrupts();
    const KeptWork work;
    raise(SIGINT);
    try {
      supervise({command("engine", "exit 0", true)}, settings);
    } catch (const Error& error) {
      _exit(exitStatus(error.code()));
    }
  });
  EXPECT_EQ(ended.status, exitStatus(Error::Code::kCancelled));
  EXPECT_THAT(runs("engine"), ElementsAre());
}

}  // namespace supervisor_test
}  // namespace palpate
