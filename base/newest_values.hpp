// SPDX-License-Identifier: Apache-2.0
// base/newest_values.hpp: the newest values of a row that may go on for days, in memory that does not grow. One thread.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace palpate {

class NewestValues {
 public:
  // `most`: that are kept, 1 or more.
  explicit NewestValues(std::size_t most) : most_(most) { values_.reserve(most); }
  // No memory is taken.
  void add(double value) noexcept {
    if (values_.size() < most_) {
      values_.push_back(value);
    } else {
      values_[count_ % most_] = value;
    }
    ++count_;
  }
  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }  // of all
  [[nodiscard]] std::vector<double> inOrder() const {                    // those that are kept, the oldest first
    std::vector<double> all = values_;
    if (count_ > most_) std::rotate(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count_ % most_), all.end());
    return all;
  }

 private:
  std::size_t most_;
  std::vector<double> values_;
  std::uint64_t count_ = 0;
};

}  // namespace palpate
