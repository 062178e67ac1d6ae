// SPDX-License-Identifier: Apache-2.0
// The servo thread makes no system call but its sleep and its clock between its first and its last tick.
//
// A child process runs a loop whose device puts a seccomp filter on the servo thread in the first tick. It allows the
// sleep, the clock (where the vDSO cannot serve it), and the exit with which the device ends the child in the last
// tick. Any other call kills the child.
#include <cstddef>

#include <gtest/gtest.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "servo/devices/placed_device.hpp"
#include "servo/loop/servo_loop.hpp"
#include "support/emulated_polhem.hpp"
#include "support/touch_scene.hpp"
#include "support/troubled.hpp"

namespace palpate {
namespace system_call_guard_test {

constexpr int kTicks = 200;
constexpr int kClean = 0;
constexpr int kNoSeccomp = 77;

bool allowOnlySleepClockAndExit() {
  constexpr auto kNumber = static_cast<unsigned>(offsetof(seccomp_data, nr));
  sock_filter program[] = {
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, kNumber),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_clock_nanosleep, 3, 0),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_clock_gettime, 2, 0),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_exit_group, 1, 0),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_KILL_PROCESS),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
  };
  sock_fprog filter{static_cast<unsigned short>(std::size(program)), program};
  return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 && prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter) == 0;
}

class GuardedDevice final : public Device {
 public:
  GuardedDevice(const Path& path, bool troubled, bool calls)
      : GuardedDevice(std::make_unique<TroubledDevice>(path, troubled), calls) {}
  explicit GuardedDevice(std::unique_ptr<Device> inner, bool calls = false) : inner_(std::move(inner)), calls_(calls) {}
  [[nodiscard]] std::string_view name() const noexcept override { return "guarded"; }
  [[nodiscard]] DeviceLimits limits() const noexcept override { return inner_->limits(); }
  [[nodiscard]] DeviceBoundary boundary() const noexcept override { return inner_->boundary(); }
  void elapse(int ticks) noexcept override { inner_->elapse(ticks); }
  [[nodiscard]] bool read(Vec3& position_W) noexcept override {
    if (++reads_ == 2 && !allowOnlySleepClockAndExit()) _exit(kNoSeccomp);
    if (calls_ && reads_ == kTicks / 2) static_cast<void>(syscall(SYS_getpid));
    return inner_->read(position_W);
  }
  [[nodiscard]] std::int64_t reportAge_ns() const noexcept override { return inner_->reportAge_ns(); }
  [[nodiscard]] bool write(const Vec3& force_W) noexcept override {
    if (reads_ == kTicks) _exit(kClean);
    return inner_->write(force_W);
  }

 private:
  std::unique_ptr<Device> inner_;
  bool calls_;
  int reads_ = 0;
};

// A Polhem on an emulated cable: its link's thread may make calls, the servo's may not.
int runChildWithPolhem() {
  const pid_t child = fork();
  if (child == 0) {
    TouchScene scene(0.2);
    PolhemParameters parameters;
    parameters.current_limit_A = 3;
    EmulatedPolhem emulated(parameters, {}, scene.path, 1e-3);
    EmulatedCable cable(emulated);
    GuardedDevice device(std::make_unique<PlacedDevice>(
        std::make_unique<PolhemDevice>(parameters, PolhemUse{.calibrated = true, .motors_checked = true},
                                       cable.opener()),
        Placement{.at_W = TouchScene::above(0)}));
    LoopParameters p;
    p.ticks = 0;
    p.record_ticks = kTicks;
    ServoLoop loop(p, *scene.algorithm, device, scene.windows, scene.tool);
    scene.publish(TouchScene::above(0), monotonicNow_ns());
    loop.start();
    while (loop.running()) {
      scene.windows.confirm(monotonicNow_ns());
      sleepUntil(monotonicNow_ns() + 300'000);
    }
    _exit(1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return status;
}

// The wait status of a child that runs the loop.
int runChild(std::string_view algorithm, bool device_calls, bool troubled = false, bool changing = false) {
  const pid_t child = fork();
  if (child == 0) {
    TouchScene scene(0.2, algorithm);
    GuardedDevice device(scene.path, troubled, device_calls);
    TroubledAlgorithm troubled_algorithm(*scene.algorithm, troubled);
    LoopParameters p = troubled ? troubledParameters() : LoopParameters{};
    p.ticks = 0;
    p.record_ticks = kTicks;
    ServoChanges changes;
    LiveTicks live(256);
    ServoLoop loop(p, troubled_algorithm, device, scene.windows, scene.tool);
    if (changing) loop.takeChangesFrom(changes);
    if (changing) loop.tellTicksTo(live);
    scene.publish(TouchScene::above(0), monotonicNow_ns());
    loop.start();
    for (std::int64_t look = 0; loop.running(); ++look) {
      confirmWithTrouble(scene.windows, look, troubled);
      if (changing) changes.give({.algorithm = makeFor(algorithm, {}, scene.volume, 4e-3), .force_limit_N = 3.0});
      sleepUntil(monotonicNow_ns() + 300'000);
    }
    _exit(1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return status;
}

class SystemCallGuard : public testing::Test {
 protected:
  void SetUp() override {
#if defined(__SANITIZE_THREAD__) || defined(__SANITIZE_ADDRESS__)
    GTEST_SKIP() << "a sanitizer makes system calls of its own";
#endif
    if (const int status = runChild("hri", false); WIFEXITED(status) && WEXITSTATUS(status) == kNoSeccomp) {
      GTEST_SKIP() << "no seccomp filters on this system";
    }
  }
};

TEST_F(SystemCallGuard, TheServoThreadOnlySleeps) {
  for (const AlgorithmEntry& entry : algorithms()) {
    const int status = runChild(entry.name, false);
    ASSERT_TRUE(WIFEXITED(status)) << entry.name << " killed by signal " << WTERMSIG(status);
    EXPECT_EQ(WEXITSTATUS(status), kClean) << entry.name;
  }
}

// With every fault that the gate knows, adaptive windowing and the passivity controller (heap_guard_test.cpp sees
// them).
TEST_F(SystemCallGuard, TheServoThreadOnlySleepsInTrouble) {
  const int status = runChild("hri", false, true);
  ASSERT_TRUE(WIFEXITED(status)) << "killed by signal " << WTERMSIG(status);
  EXPECT_EQ(WEXITSTATUS(status), kClean);
}

TEST_F(SystemCallGuard, TheServoThreadOnlySleepsWhileItIsChanged) {
  const int status = runChild("hri", false, false, true);
  ASSERT_TRUE(WIFEXITED(status)) << "killed by signal " << WTERMSIG(status);
  EXPECT_EQ(WEXITSTATUS(status), kClean);
}

TEST_F(SystemCallGuard, TheServoThreadOnlySleepsBesideAPolhem) {
  const int status = runChildWithPolhem();
  ASSERT_TRUE(WIFEXITED(status)) << "killed by signal " << WTERMSIG(status);
  EXPECT_EQ(WEXITSTATUS(status), kClean);
}

TEST_F(SystemCallGuard, ADeliberateCallIsCaught) {
  const int status = runChild("hri", true);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(WTERMSIG(status), SIGSYS);
}

}  // namespace system_call_guard_test
}  // namespace palpate
