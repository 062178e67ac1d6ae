// SPDX-License-Identifier: Apache-2.0
// apps/servo_side/stale_watch.hpp: an engine that is there and sends no windows, put into words for the servo's user:
// without a window the force goes, and an engine that is stopped or hangs can say nothing itself. One thread; no
// errors.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace palpate {

class StaleWatch {
 public:
  // An engine that is busy for less is told of nowhere: its faults are counted (`palpate top`) [ns].
  static constexpr std::int64_t kLasting_ns = 500'000'000;
  static constexpr std::int64_t kPause_ns = 10'000'000'000;  // from what is told until the next is [ns]

  // Every some milliseconds: whether the servo's newest tick had a stale window (ServoFault::kStaleWindow). What there
  // is to say, once when it has lasted and once when it is over; empty: nothing.
  [[nodiscard]] std::string look(bool is_stale, std::int64_t now_ns);
  // With another engine, or the same one that has made itself anew: what was told ends with its windows, what was not
  // begins anew.
  void beginAnew() noexcept;

 private:
  std::optional<std::int64_t> since_ns_;
  std::optional<std::int64_t> told_ns_;
  bool is_told_ = false;
};

}  // namespace palpate
