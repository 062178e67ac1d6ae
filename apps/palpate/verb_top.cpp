// SPDX-License-Identifier: Apache-2.0
// palpate top: watches a service, line by line.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include <fmt/format.h>

#include "apps/console/interrupt.hpp"
#include "apps/console/message.hpp"
#include "apps/serve/service_client.hpp"
#include "base/error.hpp"
#include "base/monotonic_clock.hpp"
#include "base/units.hpp"
#include "service/channel/usual_socket.hpp"
#include "servo/safety/faults.hpp"
#include "verbs.hpp"

namespace palpate {
namespace {

constexpr int kPatience_ms = 1000;  // then a line says that the service does not answer
constexpr int kLinesBetweenHeads = 20;
constexpr double kMiB = 1 << 20U;
constexpr const char* kProgram = "palpate top";
constexpr double kOld_ms = 500;  // a pose of a servo or an engine that stands still

struct TopArguments {
  std::string socket = usualSocket();
  double every_s = 0.5;
  int count = 0;
};

using Figures = std::map<std::string, double>;

// Whether edits are on the disk: "no" where the journal has failed, and how many were lost before the service began.
std::string keptWords(double journal_failed, double lost_records) {
  if (journal_failed > 0) return "no";
  return lost_records > 0 ? fmt::format("-{:.0f}", lost_records) : "yes";
}

class Watch {
 public:
  explicit Watch(const TopArguments& arguments) : arguments_(arguments) { client_.emplace(arguments.socket, kProgram); }

  void run() {
    for (int look = 0; arguments_.count == 0 || look < arguments_.count; ++look) {
      if (look > 0) pause();
      if (client_ || reconnect()) lookOnce();
    }
  }

 private:
  // An engine that was killed is started again by its supervisor, and this goes on with it.
  bool reconnect() {
    try {
      client_.emplace(arguments_.socket, kProgram);
      last_.clear();
      return true;
    } catch (const Error& error) {
      if (error.code() == Error::Code::kDevice) tellUser(error.what());  // it hangs, or is busy
      if (error.code() != Error::Code::kNotFound && error.code() != Error::Code::kDevice) throw;
      return false;
    }
  }

  void lookOnce() {
    try {
      const std::optional<ServiceAnswer> answer = client_->tryToAsk(wire::Verb::Status, {}, kPatience_ms);
      if (!answer) return tellUser(fmt::format("the service at {} does not answer", arguments_.socket));
      print({answer->figures.begin(), answer->figures.end()});
    } catch (const Error& error) {
      if (error.code() != Error::Code::kDevice) throw;
      client_.reset();
      tellUser(fmt::format("the service at {} has ended; Ctrl-C ends the wait for the next one", arguments_.socket));
    }
  }

  void print(const Figures& now) {
    if (lines_++ % kLinesBetweenHeads == 0)
      printText(
          "servo  ticks/s  pose [ms]  window [ms]  force [N]  contact  windows/s  edits/s  waiting  undo/redo  to disk "
          " kept    clients  "
          "memory [MiB]: engine  servo  GPU  faults\n");
    const std::int64_t now_ns = monotonicNow_ns();
    const double passed_s = static_cast<double>(now_ns - last_ns_) / kNanosecondsPerSecond;
    const auto value = [&](const char* key) { return now.contains(key) ? now.at(key) : 0; };
    const auto last = [&](const char* key) { return last_.contains(key) ? last_.at(key) : 0; };
    const auto rate = [&](const char* key) {
      return last_.contains(key) ? std::max(0.0, value(key) - last(key)) / passed_s : 0;
    };
    const bool has_servo = value("servo") > 0;
    // By the times of the poses: after a pause the newest one may be old, or the tick another servo's.
    const double posed_s = passed_s - 1e-3 * (value("pose_age_ms") - last("pose_age_ms"));
    const bool is_same = has_servo && last("servo") > 0 && value("servos") == last("servos") && posed_s > 0;
    const double ticks_per_s = is_same ? std::max(0.0, value("tick") - last("tick")) / posed_s : 0;
    printText(fmt::format(
        "{:<5}  {:>7.0f}  {:>9.1f}  {:>11.1f}  {:>9.2f}  {:<7}  {:>9.0f}  {:>7.1f}  {:>7.0f}  {:>4.0f}/{:<4.0f}  "
        "{:>7.0f}  {:<6}  "
        "{:>7.0f}  {:>20.1f}  {:>5.1f}  {:>5.1f}  {}\n",
        has_servo ? "on" : "off", ticks_per_s, value("pose_age_ms"), value("window_age_ms"), value("force_N"),
        value("force_off") > 0           ? "off"
        : value("pose_age_ms") > kOld_ms ? "old"
        : value("contact") > 0           ? "yes"
                                         : "no",
        rate("windows"), rate("edits"), value("waiting"), value("undoable"), value("redoable"),
        value("waiting_for_disk"), keptWords(value("journal_failed"), value("lost_records")), value("clients"),
        value("engine_memory_bytes") / kMiB, value("servo_memory_bytes") / kMiB, value("gpu_bytes") / kMiB,
        has_servo ? faultNames(static_cast<std::uint32_t>(value("faults"))) : "-"));
    flushResults();  // also into a pipe
    last_ = now;
    last_ns_ = now_ns;
  }

  void pause() const {
    constexpr double kLook_s = 0.05;
    for (double waited_s = 0; waited_s < arguments_.every_s; waited_s += kLook_s) {
      throwIfInterrupted(kProgram, "the service goes on");
      std::this_thread::sleep_for(std::chrono::duration<double>(kLook_s));
    }
  }

  const TopArguments& arguments_;
  std::optional<ServiceClient> client_;
  Figures last_;
  std::int64_t last_ns_ = 0;
  int lines_ = 0;
};

}  // namespace

void addTopVerb(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("top", "watch a service: rates, ages, forces, faults, edits and memory");
  auto arguments = std::make_shared<TopArguments>();
  verb->add_option("--socket", arguments->socket, "where the service listens")->capture_default_str()->check(notEmpty);
  verb->add_option("--every", arguments->every_s, "time between looks [s]")
      ->capture_default_str()
      ->check(numberFrom(0.05, 3600));
  verb->add_option("--count", arguments->count, "looks, then it ends; 0: until Ctrl-C")
      ->capture_default_str()
      ->check(numberFrom(0, 1e9));
  verb->callback([arguments] { Watch(*arguments).run(); });
}

}  // namespace palpate
