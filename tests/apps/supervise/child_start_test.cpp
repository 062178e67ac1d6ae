// SPDX-License-Identifier: Apache-2.0
// What a child is given is what the kernel says of it in /proc; a shell writes that into files.
#include "apps/supervise/child_start.hpp"

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/wait.h>

#include "base/descriptor.hpp"
#include "open_descriptors.hpp"
#include "refusal.hpp"
#include "temporary_folder.hpp"
#include "tests/apps/console/in_child.hpp"
#include "tests/apps/supervise/appears.hpp"

namespace palpate {
namespace child_start_test {

using testing::AllOf;
using testing::HasSubstr;

class ChildStart : public testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path file(const std::string& name) const { return folder_.path() / name; }
  // Runs a script in the test's folder; the status that it ended with, -1 after a signal.
  [[nodiscard]] int run(const std::string& script) const {
    const pid_t child = startChild("it", {"sh", "-c", "cd " + folder_.path().string() + "; " + script});
    int status = 0;
    EXPECT_EQ(waitpid(child, &status, 0), child);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  void makeProgram(const std::string& name, const std::string& text) const {
    std::ofstream(file(name)) << text;
    std::filesystem::permissions(file(name), std::filesystem::perms::owner_all);
  }

 private:
  TemporaryFolder folder_;
};

TEST_F(ChildStart, RunsAProgramWithItsArguments) {
  makeProgram("program", "#!/bin/sh\n[ \"$1\" = 'one word' ] && [ \"$2\" = '' ] && [ $# = 2 ] && exit 7\n");
  const pid_t child = startChild("it", {file("program").string(), "one word", ""});
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(WEXITSTATUS(status), 7);
}

TEST_F(ChildStart, InheritsTheStandardStreamsAlone) {
  const Descriptor left_open(open("/dev/null", O_RDONLY));  // not O_CLOEXEC
  ASSERT_GE(left_open.get(), 3);
  const Ended ended = inChild([this] {
    dup2(open(file("descriptors").c_str(), O_WRONLY | O_CREAT, 0600), STDOUT_FILENO);
    waitpid(startChild("it", {"ls", "/proc/self/fd"}), nullptr, 0);
  });
  EXPECT_EQ(ended.status, 0);
  EXPECT_EQ(contentsOf(file("descriptors")), "0\n1\n2\n3\n");  // 3: the folder that ls reads
}

TEST_F(ChildStart, LeadsAGroupOfItsOwn) {
  ASSERT_EQ(run("echo $$ > id; cut -d ' ' -f 5 /proc/$$/stat > group; exit 0"), 0);
  EXPECT_NE(contentsOf(file("id")), "");
  EXPECT_EQ(contentsOf(file("group")), contentsOf(file("id")));
}

// The line `name` of /proc/PID/status, a mask of signals in hexadecimal.
std::uint64_t maskIn(const std::string& status, const std::string& name) {
  std::istringstream lines(status);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with(name + ":")) return std::stoull(line.substr(name.size() + 1), nullptr, 16);
  }
  ADD_FAILURE() << name << " is not in\n" << status;
  return 0;
}
constexpr std::uint64_t bitOf(int signal) {
  return std::uint64_t{1} << (signal - 1);
}

TEST_F(ChildStart, BeginsWithSignalsAsUsual) {
  const std::filesystem::path kept = file("kept");
  const Ended ended = inChild([&] {
    for (const int signal : {SIGPIPE, SIGXFSZ, SIGINT, SIGHUP}) static_cast<void>(std::signal(signal, SIG_IGN));
    sigset_t blocked;
    sigfillset(&blocked);
    sigprocmask(SIG_SETMASK, &blocked, nullptr);
    dup2(open(kept.c_str(), O_WRONLY | O_CREAT, 0600), STDOUT_FILENO);
    waitpid(startChild("it", {"cat", "/proc/self/status"}), nullptr, 0);  // a shell would unblock them itself
  });
  EXPECT_EQ(ended.status, 0);
  const std::string status = contentsOf(kept);
  EXPECT_EQ(maskIn(status, "SigBlk"), 0U);
  EXPECT_EQ(maskIn(status, "SigIgn"), bitOf(SIGHUP));  // as nohup left it
}

TEST_F(ChildStart, GetsTheSignalOfItsParentsDeath) {
  const Ended ended = inChild([this] {
    const pid_t child = startChild("it", {"sh", "-c",
                                          "cd " + file("").string() +
                                              "; trap 'touch ended; exit 0' TERM; touch ready; "
                                              "n=0; while [ $((n += 1)) -lt 3000 ]; do sleep 0.01; done"});
    static_cast<void>(child);
    if (!appears(file("ready"))) _exit(1);
    raise(SIGKILL);
  });
  EXPECT_EQ(ended.signal, SIGKILL);
  EXPECT_TRUE(appears(file("ended")));
}

TEST_F(ChildStart, IsLookedForAlongPath) {
  makeProgram("palpate-test-program", "#!/bin/sh\nexit 9\n");
  const char* path = std::getenv("PATH");
  const std::string before = path != nullptr ? path : "";
  std::filesystem::create_directory(file("empty"));
  std::filesystem::create_directories(file("folder") / "palpate-test-program");  // a folder is no program
  setenv("PATH", (file("empty").string() + ":" + file("folder").string() + ":" + file("").string()).c_str(), 1);
  const pid_t child = startChild("it", {"palpate-test-program"});
  setenv("PATH", before.c_str(), 1);
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(WEXITSTATUS(status), 9);
}

TEST_F(ChildStart, RefusesWhatCannotBeRun) {
  const auto refused = [](const std::vector<std::string>& argv, Error::Code code) {
    return refusalOf([&] { static_cast<void>(startChild("the servo", argv)); }, code);
  };
  const long open_before = openDescriptors();
  EXPECT_THAT(
      refused({"/no/such/program"}, Error::Code::kNotFound),
      AllOf(HasSubstr("/no/such/program: "), HasSubstr("the servo cannot be started"), HasSubstr("give the path")));
  EXPECT_THAT(refused({"no-such-program"}, Error::Code::kNotFound),
              AllOf(HasSubstr("no-such-program: "), HasSubstr("put its folder into PATH")));
  makeProgram("text", "not a program");
  EXPECT_THAT(refused({file("text").string()}, Error::Code::kIo),
              AllOf(HasSubstr("the servo cannot be started (Exec format error)"), HasSubstr("; give a program")));
  EXPECT_THAT(refused({file("").string()}, Error::Code::kIo), HasSubstr("Permission denied"));
  EXPECT_THAT(refused({}, Error::Code::kBadInput), HasSubstr("the servo: no program is given"));
  EXPECT_THAT(refused({""}, Error::Code::kBadInput), HasSubstr("the servo: no program is given"));
  EXPECT_EQ(openDescriptors(), open_before);
  EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1);  // no zombie is left
}

}  // namespace child_start_test
}  // namespace palpate
