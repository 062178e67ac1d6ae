// SPDX-License-Identifier: Apache-2.0
#include "apps/rivals/child_talk.hpp"

#include <array>
#include <cerrno>
#include <csignal>

#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "apps/console/interrupt.hpp"

namespace palpate {

ChildTalk::ChildTalk(const std::vector<std::string>& words) {
  std::array<int, 2> ends{};  // a socket, not a pipe: writing after the child has ended raises no signal
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) return;
  socket_ = ends[0];
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));  // NOLINT
  arguments.push_back(nullptr);
  leftover_ = Leftover::process([&] {
    if (posix_spawn(&child_, arguments[0], &actions, nullptr, arguments.data(), environ) != 0) child_ = -1;
    return child_;
  });
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
}

ChildTalk::~ChildTalk() {
  if (socket_ >= 0) close(socket_);
  if (child_ > 0) kill(child_, SIGKILL);
  wait();
}

int ChildTalk::wait() {
  int status = -1;
  if (child_ > 0) leftover_.release();  // after waitpid() its id may belong to another process
  while (child_ > 0 && waitpid(child_, &status, 0) < 0 && errno == EINTR) {
  }
  child_ = -1;
  return status;
}

bool ChildTalk::tell(const std::string& line) {
  const std::string text = line + "\n";
  return socket_ >= 0 && send(socket_, text.data(), text.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(text.size());
}

std::optional<std::string> ChildTalk::hear() {
  constexpr int kPatience_ms = 100;
  for (;;) {
    if (const std::size_t end = heard_.find('\n'); end != std::string::npos) {
      std::string line = heard_.substr(0, end);
      heard_.erase(0, end + 1);
      return line;
    }
    throwIfInterrupted("palpate bench");
    pollfd what{socket_, POLLIN, 0};
    if (socket_ < 0) return std::nullopt;
    const int ready = poll(&what, 1, kPatience_ms);
    if (ready < 0 && errno != EINTR) return std::nullopt;
    if (ready <= 0) continue;
    std::array<char, 4096> block{};
    const ssize_t count = recv(socket_, block.data(), block.size(), 0);
    if (count <= 0) return std::nullopt;
    heard_.append(block.data(), static_cast<std::size_t>(count));
  }
}

}  // namespace palpate
