// SPDX-License-Identifier: Apache-2.0
// servo/devices/debounced_button.hpp: presses of a button whose contacts bounce, from a line that is read now and then.
//
// A press counts once the line has said so for kPressed_s in each of kFewestReports reports or more. The next one
// counts only after the line has said for kReleased_s that the button is free. So a bounce or a damaged report is no
// press, and a press that bounces is one. Times are those of the reports [ns]. Thread: one. No heap, no errors.
#pragma once

#include <cmath>
#include <cstdint>

#include "base/units.hpp"

namespace palpate {

class DebouncedButton {
 public:
  static constexpr double kPressed_s = 0.01;
  static constexpr double kReleased_s = 0.05;
  static constexpr int kFewestReports = 3;

  // What the line says in a report of this time. True: the button was pressed; once a press.
  bool read(bool line, std::int64_t time_ns) noexcept {
    if (line != line_) {
      line_ = line;
      since_ns_ = time_ns;
      reports_ = 0;
    }
    ++reports_;
    const double held_s = static_cast<double>(time_ns - since_ns_) / kNanosecondsPerSecond;
    if (!line && held_s >= kReleased_s) is_pressed_ = false;
    if (!line || is_pressed_ || reports_ < kFewestReports || held_s < kPressed_s) return false;
    is_pressed_ = true;
    return true;
  }
  // The first report in a row in which the line said what it says now.
  [[nodiscard]] bool hasJustChanged() const noexcept { return reports_ == 1; }

 private:
  bool line_ = false, is_pressed_ = false;
  int reports_ = 0;  // in which the line has said the same
  std::int64_t since_ns_ = 0;
};

}  // namespace palpate
