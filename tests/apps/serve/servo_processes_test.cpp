// SPDX-License-Identifier: Apache-2.0
// Servos are known as long as they live, and no longer: their numbers are given to others then.
#include "apps/serve/servo_processes.hpp"

#include <cerrno>
#include <csignal>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/few_descriptors.hpp"
#include "tests/support/without_call.hpp"

namespace palpate {
namespace servo_processes_test {

class Process {
 public:
  Process() : id_(fork()) {
    if (id_ == 0) {
      pause();
      _exit(0);
    }
  }
  ~Process() { end(); }
  Process(Process&& other) noexcept : id_(std::exchange(other.id_, -1)) {}
  Process& operator=(Process&&) = delete;
  void end() {
    if (id_ <= 0) return;
    kill(id_, SIGKILL);
    waitpid(std::exchange(id_, -1), nullptr, 0);
  }
  [[nodiscard]] pid_t id() const { return id_; }

 private:
  pid_t id_;
};

TEST(ServoProcesses, AreKnownAsLongAsTheyLive) {
  ServoProcesses servos;
  Process one, other;
  const pid_t number = one.id();
  EXPECT_FALSE(servos.contains(number));
  servos.note(number);
  servos.note(number);
  EXPECT_TRUE(servos.contains(number));
  EXPECT_FALSE(servos.contains(other.id()));
  servos.note(other.id());
  one.end();
  EXPECT_FALSE(servos.contains(number)) << "who has the number next is no servo";
  EXPECT_TRUE(servos.contains(other.id()));
  servos.note(number);  // it has ended
  EXPECT_FALSE(servos.contains(number));
}

// As the kernel calls processes of other containers.
TEST(ServoProcesses, NobodyIsNotKnown) {
  ServoProcesses servos;
  for (const std::int64_t nobody : {0, -1}) {
    servos.note(nobody);
    EXPECT_FALSE(servos.contains(nobody));
  }
}

// Where the kernel gives no descriptor for a process: none is left, or it has no such call.
TEST(ServoProcesses, AreKnownWithoutADescriptor) {
  ServoProcesses servos;
  Process one;
  {
    const FewDescriptors none;
    servos.note(one.id());
  }
  EXPECT_TRUE(servos.contains(one.id()));
  const pid_t number = one.id();
  one.end();
  EXPECT_FALSE(servos.contains(number));
  const pid_t old = fork();
  if (old == 0) {
    if (!loseCall(SYS_pidfd_open, ENOSYS)) _exit(2);
    servos.note(getpid());
    _exit(servos.contains(getpid()) ? 0 : 1);
  }
  int status = -1;
  waitpid(old, &status, 0);
  EXPECT_EQ(status, 0);
}

TEST(ServoProcesses, AreNoMoreThanSoMany) {
  ServoProcesses servos;
  std::vector<Process> all(ServoProcesses::kMost + 1);
  for (const Process& one : all) servos.note(one.id());
  EXPECT_FALSE(servos.contains(all.front().id()));
  for (std::size_t i = 1; i < all.size(); ++i) EXPECT_TRUE(servos.contains(all[i].id()));
}

}  // namespace servo_processes_test
}  // namespace palpate
