// SPDX-License-Identifier: Apache-2.0
#include "child_process.hpp"

#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <stdexcept>

#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace palpate {
namespace {

using Clock = std::chrono::steady_clock;

struct Pipe {
  std::array<int, 2> ends{};
  Pipe() {
    if (pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
  }
};

// In the child, between fork and exec.
[[noreturn]] void become(const Command& command, int out, int err) {
  if (!command.output_file.empty()) out = open(command.output_file.c_str(), O_WRONLY | O_CREAT, 0666);
  if (!command.error_file.empty()) err = open(command.error_file.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0666);
  if (!command.input_file.empty()) dup2(open(command.input_file.c_str(), O_RDONLY), STDIN_FILENO);
  if (command.output_unread) {
    const Pipe unread;
    close(unread.ends[0]);
    out = unread.ends[1];
  }
  dup2(out, STDOUT_FILENO);
  dup2(err, STDERR_FILENO);
  for (const int descriptor : command.closed) close(descriptor);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE})
    std::signal(signal, SIG_DFL);  // a test may run under nohup
  if (!command.folder.empty() && chdir(command.folder.c_str()) != 0) _exit(126);
  setenv("PALPATE_VALIDATION", "1", 1);  // any message of the validation layer fails the run
  for (const auto& [name, value] : command.environment) setenv(name.c_str(), value.c_str(), 1);
  if (command.file_size_limit) {
    const rlimit limit = {*command.file_size_limit, *command.file_size_limit};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  if (command.process_limit) {
    constexpr uid_t kNobody = 65534;
    const rlimit limit = {*command.process_limit, *command.process_limit};
    setrlimit(RLIMIT_NPROC, &limit);
    if (geteuid() == 0 && setuid(kNobody) != 0) _exit(126);
  }
  std::vector<std::string> words = {command.program.empty() ? PALPATE_PROGRAM : command.program};
  words.insert(words.end(), command.arguments.begin(), command.arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  execv(argv[0], argv.data());
  _exit(127);
}

// Appends what has come; false at the end of the stream.
bool drain(int descriptor, std::string& text) {
  std::array<char, 4096> buffer{};
  const ssize_t count = read(descriptor, buffer.data(), buffer.size());
  if (count > 0) text.append(buffer.data(), static_cast<std::size_t>(count));
  return count > 0;
}

// Reads both streams until they end or time is up.
void listen(const Command& command, pid_t child, int out, int err, Outcome& outcome) {
  std::array<pollfd, 2> streams = {pollfd{out, POLLIN, 0}, pollfd{err, POLLIN, 0}};
  const std::array<std::string*, 2> texts = {&outcome.out, &outcome.err};
  const auto start = Clock::now();
  bool signalled = command.signals.empty();
  std::optional<Clock::time_point> words_at;
  const auto isDue = [&] {
    if (command.signal_after_s) return Clock::now() - start > std::chrono::duration<double>(*command.signal_after_s);
    if (!words_at && outcome.err.find(command.signal_at) != std::string::npos) words_at = Clock::now();
    return words_at && Clock::now() - *words_at >= std::chrono::duration<double>(command.signal_delay_s) &&
           (command.signal_with.empty() || std::filesystem::exists(command.folder / command.signal_with));
  };
  const auto end = Clock::now() + std::chrono::duration<double>(command.timeout_s);
  while (streams[0].fd >= 0 || streams[1].fd >= 0) {
    if (Clock::now() > end) {
      outcome.timed_out = true;
      kill(child, SIGKILL);
      return;
    }
    if (poll(streams.data(), streams.size(), signalled ? 100 : 5) < 0) continue;
    for (std::size_t n = 0; n < streams.size(); ++n) {
      if (streams[n].revents != 0 && !drain(streams[n].fd, *texts[n])) streams[n].fd = -1;
    }
    if (!signalled && isDue()) {
      outcome.signalled_s = std::chrono::duration<double>(Clock::now() - start).count();
      for (const int signal : command.signals) kill(child, signal);
      signalled = true;
    }
  }
}

}  // namespace

Outcome runPalpate(const Command& command) {
  const auto start = Clock::now();
  const Pipe out, err;
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("no child process");
  if (child == 0) become(command, out.ends[1], err.ends[1]);
  close(out.ends[1]);
  close(err.ends[1]);
  Outcome outcome;
  listen(command, child, out.ends[0], err.ends[0], outcome);
  int status = 0;
  waitpid(child, &status, 0);
  close(out.ends[0]);
  close(err.ends[0]);
  if (WIFEXITED(status)) outcome.status = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) outcome.signal = WTERMSIG(status);
  outcome.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return outcome;
}

}  // namespace palpate
