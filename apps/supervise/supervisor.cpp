// SPDX-License-Identifier: Apache-2.0
#include "apps/supervise/supervisor.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>
#include <limits>
#include <optional>

#include <fmt/format.h>
#include <sys/wait.h>

#include "apps/console/interrupt.hpp"
#include "apps/console/message.hpp"
#include "apps/supervise/child_start.hpp"
#include "apps/supervise/signal_inbox.hpp"
#include "base/error.hpp"
#include "base/formatted.hpp"
#include "base/monotonic_clock.hpp"

namespace palpate {
namespace {

double now_s() noexcept {
  return 1e-9 * static_cast<double>(monotonicNow_ns());
}

bool endedWell(int status) noexcept {
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

// "killed by signal 9 (SIGKILL)", "ended with status 3".
std::string endInWords(int status) {
  if (WIFEXITED(status)) return fmt::format("ended with status {}", WEXITSTATUS(status));
  const int signal = WTERMSIG(status);
  const char* abbreviation = sigabbrev_np(signal);
  return abbreviation != nullptr ? fmt::format("killed by signal {} (SIG{})", signal, abbreviation)
                                 : fmt::format("killed by signal {}", signal);
}

struct Supervised {
  SupervisedCommand command;
  RestartPace pace;
  pid_t id = 0;                          // 0: it does not run
  double started_s = 0;                  // [s]
  std::optional<double> next_start_s{};  // [s]
  bool is_killed = false;                // as it did not end in time
};

class Supervision {
 public:
  Supervision(const std::vector<SupervisedCommand>& commands, const SupervisorSettings& settings)
      : settings_(settings) {
    for (const SupervisedCommand& command : commands) {
      all_.push_back({.command = command, .pace = RestartPace(settings.restarts)});
    }
  }

  SupervisionEnd run() {
    try {
      for (Supervised& one : all_) start(one);
      while (!isOver()) step();
    } catch (...) {
      endAll();
      throw;
    }
    endAll();
    return end_;
  }

 private:
  template <class... Args>
  void tell(fmt::format_string<Args...> format, Args&&... args) noexcept {
    try {
      const std::string line = fmt::format(format, std::forward<Args>(args)...);
      if (settings_.tell) {
        settings_.tell(line);
      } else {
        tellUser(line);
      }
    } catch (...) {  // a line less is no reason to leave a hand with a servo that nobody watches
    }
  }

  static void start(Supervised& one) {
    one.next_start_s.reset();
    one.started_s = now_s();
    one.id = startChild(one.command.name, one.command.argv);
  }

  [[nodiscard]] bool isOver() const {
    return is_done_ || end_.signal != 0 ||
           std::ranges::all_of(all_, [](const Supervised& one) { return one.id == 0 && !one.next_start_s; });
  }
  [[nodiscard]] bool anyRuns() const {
    return std::ranges::any_of(all_, [](const Supervised& one) { return one.id != 0; });
  }

  void step() {
    waitUntil(nextStart_s());
    if (inbox_.take(SIGHUP) > 0) hangUp();
    end_.signal = stopRequest();
    if (end_.signal != 0) return;
    judgeEnded(true);  // the essential ones first: once all is ended, nothing is started again
    if (!is_done_) judgeEnded(false);
    if (is_done_) return;
    for (Supervised& one : all_) {
      if (one.next_start_s && *one.next_start_s <= now_s()) restart(one);
    }
  }

  [[nodiscard]] double nextStart_s() const {
    double next_s = std::numeric_limits<double>::infinity();
    for (const Supervised& one : all_) next_s = std::min(next_s, one.next_start_s.value_or(next_s));
    return next_s;
  }

  void waitUntil(double then_s) noexcept {
    constexpr double kMost_s = 3600;  // poll(2) counts milliseconds in an int
    const double wait_s = std::clamp(then_s - now_s(), 0.0, kMost_s);
    inbox_.wait(static_cast<int>(std::ceil(1e3 * wait_s)));
  }

  void hangUp() const noexcept {
    for (const Supervised& one : all_) {
      if (one.id != 0) kill(one.id, SIGHUP);
    }
  }

  // The signal that asks for the end, if one came since the last look.
  int stopRequest() noexcept {
    int request = 0;
    for (const int signal : {SIGINT, SIGTERM}) {
      if (inbox_.take(signal) > 0) request = signal;
    }
    return request;
  }

  void judgeEnded(bool essential) {
    for (Supervised& one : all_) {
      if (one.command.essential != essential) continue;
      if (const std::optional<int> status = statusIfEnded(one)) judge(one, *status);
    }
  }

  // As waitpid() tells it. While a process is not waited for, its id cannot be another's. So what is left of its group
  // gets its signal first.
  static std::optional<int> statusIfEnded(Supervised& one) noexcept {
    if (one.id == 0) return std::nullopt;
    siginfo_t ended{};
    const int failure = waitid(P_PID, static_cast<id_t>(one.id), &ended, WEXITED | WNOHANG | WNOWAIT);
    if (failure == 0 && ended.si_pid == 0) return std::nullopt;
    if (failure != 0 && errno == EINTR) return std::nullopt;
    constexpr int kUnknown = 1 << 8;  // status 1: somebody else waited for it
    int status = kUnknown;
    if (failure == 0) {
      kill(-one.id, SIGTERM);
      waitpid(one.id, &status, 0);
    }
    one.id = 0;
    return status;
  }

  void judge(Supervised& one, int status) {
    const std::string& name = one.command.name;
    if (WIFEXITED(status) && std::ranges::count(one.command.hopeless, WEXITSTATUS(status)) > 0) {
      tell("{}: {}; it would end so again", name, endInWords(status));
      throw Error(Error::Code::kIo, name, endInWords(status) + ", as it would again",
                  "mend what its messages say, which are above");
    }
    if (!endedWell(status)) {
      planRestart(one, endInWords(status), now_s() - one.started_s);
    } else if (one.command.essential) {
      is_done_ = true;
      tell("{}: {}; so all is ended", name, endInWords(status));
    } else {
      tell("{}: {}; it is not started again", name, endInWords(status));
    }
  }

  void planRestart(Supervised& one, const std::string& death, double lived_s) {
    const std::string& name = one.command.name;
    const double died_s = now_s();
    const std::optional<double> wait_s = one.pace.afterDeath(died_s, lived_s);
    if (!wait_s) {
      tell("{}: {}; it is given up", name, death);
      throw Error(
          Error::Code::kIo, name,
          fmt::format("it died {} times within {} s, the last time: {}", settings_.restarts.most_short_lives,
                      settings_.restarts.short_lives_within_s, death),
          "mend what its messages say, which are above, or see what it does alone: " + listed(one.command.argv, " "));
    }
    one.next_start_s = died_s + *wait_s;
    tell("{}: {}; it is started again {}", name, death, *wait_s == 0 ? "at once" : fmt::format("in {} s", *wait_s));
  }

  void restart(Supervised& one) {
    try {
      start(one);
      ++end_.restarts;
    } catch (const Error& error) {  // its file is being replaced, or there is no process left; that may pass
      planRestart(one, fmt::format("not started ({})", error.reason()), 0);
    }
  }

  // --- the end ------------------------------------------------------------------------------------------------------

  void endAll() noexcept {
    tellThemToEnd();
    const double told_s = now_s();
    while (const std::optional<double> patience_s = shortestPatience()) {
      awaitEnds(SIGTERM, told_s + *patience_s);
      for (Supervised& one : all_) {
        if (one.id == 0 || one.is_killed || patienceFor(one) > *patience_s) continue;
        one.is_killed = true;
        tell("{}: still there {} s after SIGTERM; it is killed", one.command.name, *patience_s);
        kill(-one.id, SIGKILL);
        ++end_.killed;
      }
    }
    awaitEnds(SIGKILL, now_s() + settings_.patience_s);
    for (const Supervised& one : all_) {
      if (one.id == 0) continue;
      tell("{}: process {} hangs in the kernel and cannot be killed; it is left behind", one.command.name, one.id);
    }
  }

  [[nodiscard]] double patienceFor(const Supervised& one) const noexcept {
    return one.command.patience_s.value_or(settings_.patience_s);
  }
  [[nodiscard]] std::optional<double> shortestPatience() const noexcept {
    std::optional<double> shortest;
    for (const Supervised& one : all_)
      if (one.id != 0 && !one.is_killed) shortest = std::min(shortest.value_or(patienceFor(one)), patienceFor(one));
    return shortest;
  }

  void tellThemToEnd() const noexcept {
    for (const Supervised& one : all_) {
      if (one.id == 0) continue;
      kill(-one.id, SIGTERM);
      kill(-one.id, SIGCONT);  // one that was stopped does not see the other
    }
  }

  // Dying of the signal that it was sent is an end in good order.
  void awaitEnds(int sent, double until_s) noexcept {
    for (;;) {
      for (Supervised& one : all_) {
        const std::optional<int> status = statusIfEnded(one);
        if (!status || endedWell(*status)) continue;
        if (WIFSIGNALED(*status) && WTERMSIG(*status) == sent) continue;
        tell("{}: {} when it was told to end", one.command.name, endInWords(*status));
      }
      if (!anyRuns() || now_s() >= until_s) return;
      waitUntil(until_s);
      if (stopRequest() != 0) tellThemToEnd();
    }
  }

  SupervisorSettings settings_;
  SignalInbox inbox_;
  std::vector<Supervised> all_;
  bool is_done_ = false;  // an essential one ended with status 0
  SupervisionEnd end_;
};

}  // namespace

SupervisionEnd supervise(const std::vector<SupervisedCommand>& commands, const SupervisorSettings& settings) {
  if (commands.empty()) refuse("supervise", "no command is given", "give one at least");
  for (const SupervisedCommand& command : commands) {
    if (command.name.empty()) refuse("supervise", "a command has no name", "give each a name for messages");
    if (command.argv.empty() || command.argv.front().empty()) {
      refuse(command.name, "no program is given", "give a program and its arguments");
    }
  }
  checkSetting(settings.patience_s >= 0, "patience", settings.patience_s, "give 0 or more");
  // A request that comes before the inbox is there must not end the process with children in it.
  const KeptWork orderly;
  Supervision supervision(commands, settings);
  throwIfInterrupted("supervise", "nothing was started; start it again");
  return supervision.run();
}

}  // namespace palpate
