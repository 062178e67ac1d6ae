// SPDX-License-Identifier: Apache-2.0
// The servo's process has no rights but those that it needs, when it stays and when an engine starts it: by the
// kernel's account of each of its threads, while it holds a contact.
#include <fstream>
#include <map>
#include <thread>

#include <linux/capability.h>
#include <sched.h>
#include <sys/mman.h>

#include "service/sandbox/call_filter.hpp"
#include "service_processes.hpp"
#include "servo/loop/real_time.hpp"
#include "servo/loop/servo_loop.hpp"

namespace palpate {
namespace servo_rights_test {

using testing::HasSubstr;
using testing::Not;

constexpr const char* kNone = "0000000000000000";
constexpr const char* kSphere = "phantom:sphere?size=32";

// Those that may be left where no limit gives real time.
constexpr std::uint64_t kOfRealTime = 1ULL << CAP_SYS_NICE | 1ULL << CAP_IPC_LOCK;

std::map<std::string, std::string> statusOf(const std::filesystem::path& task) {
  std::map<std::string, std::string> status;
  std::ifstream file(task / "status");
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(":\t");
    if (colon != line.npos) status[line.substr(0, colon)] = line.substr(colon + 2);
  }
  return status;
}

class ServoRights : public ServiceTest {
 protected:
  void SetUp() override { write("press.csv", "time_s,x_m,y_m,z_m\n0,0,0,0.014\n0.3,0,0,0.0102\n"); }
  // Its threads, of which one is the loop's.
  static void expectNoRights(pid_t process) {
    int threads = 0;
    for (const auto& task : std::filesystem::directory_iterator(fmt::format("/proc/{}/task", process))) {
      std::map<std::string, std::string> status = statusOf(task.path());
      ++threads;
      EXPECT_EQ(status["NoNewPrivs"], "1") << status["Name"];
      EXPECT_EQ(status["Seccomp"], hasCallFilters() ? "2" : statusOf("/proc/self")["Seccomp"]) << status["Name"];
      for (const char* set : {"CapInh", "CapAmb"}) EXPECT_EQ(status[set], kNone) << status["Name"];
      for (const char* set : {"CapPrm", "CapEff"})
        EXPECT_EQ(std::stoull(status[set], nullptr, 16) & ~kOfRealTime, 0U) << status["Name"];
    }
    EXPECT_GE(threads, 2);
  }
  // How the loop's thread is scheduled; -1: there is none.
  static int loopPolicy(pid_t process) {
    for (const auto& task : std::filesystem::directory_iterator(fmt::format("/proc/{}/task", process)))
      if (statusOf(task.path())["Name"] == "servo") return sched_getscheduler(std::stoi(task.path().filename()));
    return -1;
  }
  // The servo of `parent`; 0: it has none yet.
  static pid_t servoOf(pid_t parent) {
    std::ifstream children(fmt::format("/proc/{0}/task/{0}/children", parent));
    for (pid_t child = 0; children >> child;)
      if (statusOf(fmt::format("/proc/{}", child))["Name"] == "palpate-servo") return child;
    return 0;
  }
};

// Real time stays, where this user may have it: by the kernel's account, else by the servo's own words.
TEST_F(ServoRights, RealTimeIsNotGivenUp) {
  RealTimeStatus may;
  std::thread([&] { may = becomeRealTime(LoopParameters{}.priority); }).join();
  munlockall();
  serve({kSphere, "--path", "press.csv"});
  join();
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["force_N"] > 0.3; })) << contentsOf(file("servo.log"));
  const std::string said = contentsOf(file("servo.log"));
  EXPECT_EQ(loopPolicy(servo.id()) == SCHED_FIFO, may.fifo) << said;
  EXPECT_EQ(said.find("no real-time priority") == std::string::npos, may.fifo) << said;
  EXPECT_EQ(said.find("memory not locked") == std::string::npos, may.memory_locked) << said;
  EXPECT_EQ(statusOf(fmt::format("/proc/{}", servo.id()))["VmLck"].find(" 0 kB") == std::string::npos,
            may.memory_locked);
}

// One that may not have it says so, once for a loop, and what to do.
TEST_F(ServoRights, MissingRealTimeIsTold) {
  serve({kSphere, "--path", "press.csv"});
  Words command = {"--rtprio=0", "--memlock=0"};
  if (geteuid() == 0) command = command + Words{"setpriv", "--bounding-set", "-sys_nice,-ipc_lock,-sys_resource"};
  servo = RunningProgram("/usr/bin/prlimit", command + Words{PALPATE_PROGRAM, "servo"}, folder(), "servo.log");
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["force_N"] > 0.3; })) << contentsOf(file("servo.log"));
  EXPECT_NE(loopPolicy(servo.id()), SCHED_FIFO);
  for (const char* words : {"servo: no real-time priority (SCHED_FIFO ", "servo: memory not locked: "}) {
    const std::string said = contentsOf(file("servo.log"));
    const std::size_t first = said.find(words);
    EXPECT_NE(first, std::string::npos) << said;
    EXPECT_EQ(said.find(words, first + 1), std::string::npos) << said;
  }
}

TEST_F(ServoRights, AreGivenUpByOneThatStays) {
  serve({kSphere, "--path", "press.csv"});
  join();
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["force_N"] > 0.3; })) << contentsOf(file("servo.log"));
  expectNoRights(servo.id());
  EXPECT_THAT(contentsOf(file("servo.log")), HasSubstr("servo: it has given up new privileges, "));
  EXPECT_EQ(contentsOf(file("servo.log")).find("most system calls") != std::string::npos, hasCallFilters());
  // Another engine, of another scene: device and loop begin anew behind the same fences.
  engine.end(SIGKILL);
  serve({kSphere, "--path", "press.csv", "--stiffness", "500"});
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["force_N"] > 0.15; })) << contentsOf(file("servo.log"));
  expectNoRights(servo.id());
  const int status = servo.end(SIGTERM);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
}

TEST_F(ServoRights, AreGivenUpByOneThatAnEngineStarts) {
  RunningProgram touch(PALPATE_PROGRAM, {"touch", kSphere, "--service", "--seconds", "20", "--picture", "off"},
                       folder(), "touch.log");
  pid_t child = 0;
  const auto has_loop = [&] {
    child = servoOf(touch.id());
    return child > 0 && statusOf(fmt::format("/proc/{}", child))["Threads"] != "1";
  };
  for (int look = 0; look < 1000 && !has_loop() && !touch.hasEnded(); ++look)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  ASSERT_GT(child, 0) << contentsOf(file("touch.log"));
  expectNoRights(child);
  if (hasCallFilters()) {
    EXPECT_THAT(contentsOf(file("touch.log")), Not(HasSubstr("it has given up")));  // it tells what is missing alone
  }
}

// For a debugger.
TEST_F(ServoRights, AreKeptWhereThatIsAskedFor) {
  servo = RunningProgram(PALPATE_PROGRAM, {"servo", "--no-sandbox"}, folder(), "servo.log");
  EXPECT_TRUE(awaitSaid("waiting for an engine", "servo.log"));
  EXPECT_THAT(contentsOf(file("servo.log")), HasSubstr("--no-sandbox: it keeps all its rights"));
  EXPECT_THAT(contentsOf(file("servo.log")), Not(HasSubstr("given up")));
  EXPECT_EQ(statusOf(fmt::format("/proc/{}", servo.id()))["Seccomp"], statusOf("/proc/self")["Seccomp"]);
}

}  // namespace servo_rights_test
}  // namespace palpate
