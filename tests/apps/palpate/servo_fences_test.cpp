// SPDX-License-Identifier: Apache-2.0
// What a servo's process can still do once it has given up its rights: tried from within the program itself, by a
// library that is preloaded into it (servo_probe.cpp). Each row is a sentence of docs/service.md ("What the servo gives
// up"). Behind all its fences the servo then does its work.
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <thread>

#include <fcntl.h>
#include <sys/mman.h>

#include "base/descriptor.hpp"
#include "service/channel/channel.hpp"
#include "service/sandbox/call_filter.hpp"
#include "service/sandbox/file_fence.hpp"
#include "service_processes.hpp"

namespace palpate {
namespace servo_fences_test {

using testing::HasSubstr;

constexpr int kKilled = 1000 + SIGSYS;

struct Attempt {
  const char* name;
  int expected;  // errno; 0: it works
  int landlock;  // the version of Landlock without which it is not refused; 0: by the other fences alone
};

constexpr Attempt kAttempts[] = {
    // "It connects to nobody": no client of an engine, and neither is a child of it.
    {"call", EPERM, 0},
    {"call-from-child", EPERM, 0},
    {"broker-opens-file", EACCES, 0},
    // "No machine code comes into it."
    {"code-in-memory", EPERM, 0},
    {"code-in-page", EPERM, 0},
    {"code-in-file", EPERM, 0},
    {"library", EPERM, 0},
    {"program", kKilled, 0},
    // "Of /dev it has USB alone."
    {"device-read", EACCES, 1},
    {"device-write", EACCES, 1},
    {"shared-read", EACCES, 1},
    {"shared-write", EACCES, 1},
    // "It reads what the user may read", and writes in its own folder alone.
    {"file-read", 0, 0},
    {"file-empty", EPERM, 0},
    {"file-lock", EPERM, 0},
    {"socket-folder-lock", EPERM, 0},
    {"file-write", EACCES, 1},
    {"file-make", EACCES, 1},
    {"file-remove", EACCES, 1},
    {"own-make", 0, 0},
    {"own-remove", 0, 0},
    {"own-memory", EACCES, 0},
    {"left-open", EBADF, 0},
    {"input", ENODATA, 0},
    {"output", EBADF, 0},
    {"error-output", EBADF, 0},
    // "Sockets are for whole packets."
    {"internet", EPERM, 0},
    {"desktop", EPERM, 0},
    // "Signals to others", and their scheduling.
    {"signal-parent", EPERM, 0},
    {"signal-broker", EPERM, 0},
    {"schedule-parent", EPERM, 0},
    {"schedule-broker", EPERM, 0},
    {"schedule-itself", 0, 0},
    {"limit-parent", EPERM, 0},
    {"done", 0, 0},
};

class ServoFences : public ServiceTest {
 protected:
  ~ServoFences() override {
    for (const char* name : {"LD_PRELOAD", "PALPATE_PROBE_SOCKET", "PALPATE_PROBE_FILE", "PALPATE_PROBE_SHARED",
                             "PALPATE_PROBE_OWN", "PALPATE_PROBE_LEFT"})
      unsetenv(name);
    if (!shared_.empty()) shm_unlink(shared_.c_str());
  }
  void SetUp() override {
    write("press.csv", "time_s,x_m,y_m,z_m\n0,0,0,0.014\n0.3,0,0,0.0102\n");
    write("words", "words");
  }
  void joinWithProbe() {
    setProbe();
    join();
    unsetenv("LD_PRELOAD");
  }
  // For programs that are started now.
  void setProbe() {
    setenv("PALPATE_PROBE_SOCKET", file("other.sock").c_str(), 1);
    setenv("PALPATE_PROBE_FILE", file("words").c_str(), 1);
    setenv("PALPATE_PROBE_OWN", file("run/palpate/calibrated").c_str(), 1);
    setenv("PALPATE_PROBE_LEFT", std::to_string(left_.get()).c_str(), 1);
    shared_ = "/palpate-probe-" + std::to_string(getpid());
    const Descriptor memory(shm_open(shared_.c_str(), O_RDWR | O_CREAT | O_EXCL, 0600));
    setenv("PALPATE_PROBE_SHARED", shared_.c_str(), 1);
    setenv("LD_PRELOAD", PALPATE_SERVO_PROBE, 1);
  }
  // What the probe said; it ends with "done".
  [[nodiscard]] std::map<std::string, int> said() const { return saidIn(contentsOf(file("servo.log"))); }
  [[nodiscard]] static std::map<std::string, int> saidIn(const std::string& text) {
    std::map<std::string, int> all;
    std::istringstream log(text);
    for (std::string line; std::getline(log, line);) {
      std::istringstream words(line);
      std::string probe, name;
      int result = -1;
      if (words >> probe >> name >> result && probe == "probe") all[name] = result;
    }
    return all;
  }

  // A servo that is started now inherits it. So high a number is nothing else's in there.
  const Descriptor left_{fcntl(Descriptor(open("/dev/null", O_RDWR)).get(), F_DUPFD, 200)};

 private:
  std::string shared_;
};

TEST_F(ServoFences, HoldFromWithin) {
  if (!hasCallFilters()) GTEST_SKIP() << "this kernel has no seccomp";
  Listener other(file("other.sock").string());
  joinWithProbe();
  ASSERT_TRUE(awaitSaid("probe done", "servo.log")) << contentsOf(file("servo.log"));
  std::map<std::string, int> results = said();
  for (const Attempt& one : kAttempts) {
    if (one.landlock > landlockVersion()) continue;  // told in the servo's first line
    ASSERT_TRUE(results.contains(one.name)) << one.name;
    EXPECT_EQ(results[one.name], one.expected) << one.name;
  }
  EXPECT_FALSE(other.accept().open()) << "nobody was called up";
  EXPECT_EQ(contentsOf(file("words")), "words");
  // And yet it does its work, with this engine and with the next one.
  for (const char* stiffness : {"600", "500"}) {
    serve({"phantom:sphere?size=32", "--path", "press.csv", "--stiffness", stiffness});
    EXPECT_TRUE(await([](const nlohmann::json& now) { return now["force_N"] > 0.15; }))
        << contentsOf(file("servo.log"));
    engine.end(SIGKILL);
  }
}

// As a shell gives it to a program: one descriptor to read and to write, three times. What is typed is not the servo's
// to read; what it says is there.
TEST_F(ServoFences, ATerminalIsThereToWriteToAlone) {
  if (!hasCallFilters()) GTEST_SKIP() << "this kernel has no seccomp";
  const Descriptor screen(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK));
  if (!screen || grantpt(screen.get()) != 0 || unlockpt(screen.get()) != 0)
    GTEST_SKIP() << "this machine gives no terminal";
  const std::string terminal = ptsname(screen.get());
  ASSERT_EQ(::write(screen.get(), "secret\n", 7), 7);  // there to be read, so a read that is let through ends
  setProbe();
  servo = RunningProgram("/bin/sh", {"-c", "exec \"$0\" servo <>\"$1\" >&0 2>&0", PALPATE_PROGRAM, terminal}, folder(),
                         "unused.log");
  unsetenv("LD_PRELOAD");
  std::string shown;
  for (int look = 0; look < 1000 && shown.find("probe done") == shown.npos; ++look) {
    char bytes[4096];
    const ssize_t got = ::read(screen.get(), bytes, sizeof bytes);
    if (got > 0) shown.append(bytes, static_cast<std::size_t>(got));
    if (got <= 0) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  const std::map<std::string, int> results = saidIn(shown);
  ASSERT_TRUE(results.contains("done")) << shown;
  EXPECT_EQ(results.at("output"), EBADF);
  EXPECT_EQ(results.at("error-output"), EBADF);
  EXPECT_EQ(results.at("input"), ENODATA);
}

// In the words of docs/service.md, where this system has all of it.
TEST_F(ServoFences, SaysWhatItHasGivenUp) {
  join();
  ASSERT_TRUE(awaitSaid("waiting for an engine", "servo.log"));
  const std::string said = contentsOf(file("servo.log")), first = said.substr(0, said.find('\n'));
  EXPECT_THAT(first, HasSubstr("palpate: servo: it has given up new privileges, "));
  EXPECT_EQ(first.find("start it as whoever sits at the machine") != first.npos, geteuid() == 0);
  if (landlockVersion() > 0 && hasCallFilters()) {
    EXPECT_THAT(first, HasSubstr("being looked into, all of /dev but USB, writing files outside of " +
                                 file("run/palpate/calibrated").string() + ", most system calls"));
  }
}

// What it needs for a scene with meshes was loaded before, and a file is read in a child.
TEST_F(ServoFences, MeshesAreFeltBehindThem) {
  write("plate.obj", "v -9 -9 10\nv 9 -9 10\nv 0 9 10\nv 0 0 2\nf 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1\n");
  serve({"phantom:sphere?size=32", "--path", "press.csv", "--object", "mesh:file=" + file("plate.obj").string()});
  join();
  EXPECT_TRUE(awaitServo()) << contentsOf(file("servo.log")) << contentsOf(file("serve.log"));
  // Nobody of this user looks into it; root may, and finds nothing that is written and run, or is no file's.
  std::ifstream maps("/proc/" + std::to_string(servo.id()) + "/maps");
  std::string line;
  EXPECT_EQ(static_cast<bool>(std::getline(maps, line)), geteuid() == 0);
  for (; maps; std::getline(maps, line)) {
    const std::string rights = line.substr(line.find(' ') + 1, 4);
    if (rights[2] != 'x') continue;
    EXPECT_EQ(rights[1], '-') << line;
    EXPECT_TRUE(line.find('/') != line.npos || line.find("[v") != line.npos) << line;  // the kernel's own: [vdso]
  }
}

// Its broker is needed for the next engine. Without one whoever watches over the servo starts another.
TEST_F(ServoFences, AServoWithoutABrokerEnds) {
  join();
  ASSERT_TRUE(awaitSaid("waiting for an engine", "servo.log")) << contentsOf(file("servo.log"));
  pid_t broker = 0;
  std::ifstream(fmt::format("/proc/{0}/task/{0}/children", servo.id())) >> broker;
  ASSERT_GT(broker, 0);
  EXPECT_EQ(contentsOf(fmt::format("/proc/{}/comm", broker)), "palpate-broker\n");
  kill(broker, SIGKILL);
  for (int look = 0; look < 500 && !servo.hasEnded(); ++look)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_TRUE(servo.hasEnded());
  EXPECT_THAT(contentsOf(file("servo.log")), HasSubstr("the servo's broker: its process has ended"));
}

}  // namespace servo_fences_test
}  // namespace palpate
