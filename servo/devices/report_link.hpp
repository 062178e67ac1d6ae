// SPDX-License-Identifier: Apache-2.0
// servo/devices/report_link.hpp: keeps a device's reports flowing beside the servo, which never waits for the bus.
//
// A thread of its own writes and reads. The servo takes the newest report and leaves the newest command; both are
// wait-free and make no system call. A device that answers sends one report for each that it gets: the thread writes
// and then waits for the answer, so the device sets the pace. A device that does not answer is only read.
//   A command that is older than `command_life_s` is not written again: `rest` is, a report without force. So a servo
// that stands still cannot leave a force on the hand.
//   A device that was asked and said nothing for `forgets_s`, or a machine that slept meanwhile, may have been switched
// off and on: what it says then is of a new connection.
//   If the device goes away, the thread tries to open it again, every `reopen_s`. A device that comes back may have
// forgotten everything; its reports carry the number of the connection.
// Without the thread (never start()ed), exchange() does one round in the caller's thread, for the simulated clock:
// there a command has no age.
// Threads: start(), exchange() and the constructor by the set-up thread; newest(), post() and askOnce() by the servo;
// figures() by any. Times: CLOCK_MONOTONIC [ns].
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <thread>

#include "servo/devices/latency_histogram.hpp"
#include "servo/devices/report_port.hpp"
#include "servo/window/triple_buffer.hpp"

namespace palpate {

struct LinkSettings {
  bool answers = true;                                         // one report for each that is written
  Report rest = {};                                            // written where there is no command that may be
  double command_life_s = 0.02;                                // [s]
  int answer_ms = 10;                                          // an answer that takes longer counts as lost [ms]
  double reopen_s = 0.25;                                      // [s]
  double forgets_s = std::numeric_limits<double>::infinity();  // of a device that answers, with the thread [s]
  double interval_s = 0;  // of the reports of a device that does not answer, while it moves; 0: not stated [s]
  // What a report makes of what was known before, for a device whose reports tell a part each; empty: the report is
  // all. False: it is no report of the device. Called by the link's thread.
  std::function<bool(Report& known, const Report& report)> fold = {};
  // Whether more reports must follow what is known within the interval; empty: never.
  std::function<bool(const Report&)> moves = {};
  // Called first in the link's thread, as to give it a priority; may be empty.
  std::function<void()> thread_begins = {};
};

struct Received {
  Report report;
  std::int64_t time_ns = 0;    // when it came
  std::int64_t asked_ns = 0;   // when the oldest write was begun that it may answer: what it tells is no older
  std::int64_t silent_ns = 0;  // in all until then: while the device was asked and said nothing that is a report of its
  bool unasked = false;        // it came of its own accord: nobody knows how old it is
  std::uint64_t number = 0;    // of the report, from 1 on; 0: none has come
  std::uint64_t connection = 0;  // from 1 on
  std::uint64_t requests = 0;    // of askOnce(), that it answers or comes after; rather too few than too many
};

// What became of the reports.
struct LinkFigures {
  std::uint64_t written = 0, received = 0;
  std::uint64_t lost = 0;        // answers that did not come in time; or gaps in a flow of reports, by its interval
  std::uint64_t superseded = 0;  // read, but a newer one was there already
  std::uint64_t refused = 0;     // writes
  std::uint64_t rests = 0;       // written instead of a command that was too old
  std::uint64_t disconnects = 0, reconnects = 0;
  double write_p50_us = 0, write_p99_us = 0, write_max_us = 0;
};

class ReportLink {
 public:
  // `open` is called once at once, and again after the device went away. Throws what `open` throws.
  ReportLink(PortOpener open, LinkSettings settings);
  ~ReportLink();  // stops the thread; it writes `rest` last

  void start();
  // Before start(): waits for a report that comes of its own accord, as most devices send one at first. False: none.
  bool listen(int most_ms) noexcept;
  // One round: writes the newest command (or what must be), waits for the answer. False: nothing came, or the device is
  // gone; then the next call tries to open it.
  bool exchange() noexcept;

  [[nodiscard]] const Received& newest() noexcept { return received_.latest(); }
  [[nodiscard]] bool connected() const noexcept { return connected_.load(std::memory_order_acquire); }
  // The number of the newest connection, which may be over. Any thread.
  [[nodiscard]] std::uint64_t connection() const noexcept { return connection_.load(std::memory_order_acquire); }
  void post(const Report& command, std::int64_t now_ns) noexcept;
  // Writes `request` once, before any command. One that was not written yet is replaced.
  void askOnce(const Report& request) noexcept;
  [[nodiscard]] LinkFigures figures() const noexcept;

 private:
  struct Command {
    Report report;
    std::int64_t time_ns = 0;
    bool given = false;
  };
  using Counter = std::atomic<std::uint64_t>;

  void run(const std::stop_token& stop);
  [[nodiscard]] bool reopen() noexcept;
  void lose() noexcept;
  [[nodiscard]] const Report& outgoing(bool& is_request) noexcept;
  [[nodiscard]] bool writeNext() noexcept;
  [[nodiscard]] PortRead readWithin(Report& report, int most_ms) noexcept;
  void countGap() noexcept;
  [[nodiscard]] bool fold(const Report& report) noexcept;
  void beSilent(std::int64_t since_ns) noexcept;
  [[nodiscard]] bool mayHaveForgotten() noexcept;
  void tell() noexcept;

  PortOpener open_;
  LinkSettings settings_;
  std::unique_ptr<ReportPort> port_;
  bool threaded_ = false;
  TripleBuffer<Received> received_;
  TripleBuffer<Command> commands_;
  TripleBuffer<Report> requests_;
  std::atomic<bool> connected_{false}, asked_{false};
  std::atomic<std::uint64_t> connection_{1};
  Received last_;
  std::int64_t asked_ns_ = 0;                                           // of the oldest write without an answer
  bool waits_ = false;                                                  // there is one
  std::int64_t silence_ns_ = 0;                                         // since the last report
  std::int64_t slept_ns_ = 0;                                           // by the machine, when it came
  int answers_to_request_ = 0;                                          // that are still to come
  std::int64_t lost_at_ns_ = std::numeric_limits<std::int64_t>::min();  // when the device went away last
  Counter written_{0}, lost_{0}, superseded_{0}, refused_{0}, rests_{0}, disconnects_{0}, reconnects_{0}, taken_{0};
  LatencyHistogram writes_;
  std::jthread thread_;  // last member: it uses the others
};

}  // namespace palpate
