// SPDX-License-Identifier: Apache-2.0
// Servos are known as long as they live, and no longer: their numbers are given to others then.
#include "apps/serve/servo_processes.hpp"

#include <csignal>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

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

TEST(ServoProcesses, AreNoMoreThanSoMany) {
  ServoProcesses servos;
  std::vector<Process> all(ServoProcesses::kMost + 1);
  for (const Process& one : all) servos.note(one.id());
  EXPECT_FALSE(servos.contains(all.front().id()));
  for (std::size_t i = 1; i < all.size(); ++i) EXPECT_TRUE(servos.contains(all[i].id()));
}

}  // namespace servo_processes_test
}  // namespace palpate
