// SPDX-License-Identifier: Apache-2.0
// engine/passes/submission_size.hpp: how many bricks to submit at a time, when a brick may take a microsecond or a
// tenth of a second. One thread; no cost.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace palpate {

// Begins small, and goes for kTarget_s a submission: then work can be cancelled and its progress told in time, no
// driver times out, and the cost of submitting (some 50 us) is negligible.
class SubmissionSize {
 public:
  static constexpr double kTarget_s = 0.1;     // of one submission [s]
  static constexpr std::uint32_t kFirst = 64;  // bricks of which nothing is known yet
  static constexpr double kMostGrowth = 4;     // from one to the next

  explicit SubmissionSize(std::uint32_t most) noexcept : most_(most), bricks_(std::min(kFirst, most)) {}

  [[nodiscard]] std::uint32_t bricks() const noexcept { return bricks_; }  // 1 to `most`
  // The last submission had so many and took so long.
  void took(std::uint32_t bricks, double seconds) noexcept {
    const double share = kTarget_s / std::max(seconds, 1e-9);
    const double next = std::floor(static_cast<double>(bricks) * std::min(share, kMostGrowth));
    bricks_ = static_cast<std::uint32_t>(std::clamp(next, 1.0, static_cast<double>(most_)));
  }

 private:
  std::uint32_t most_;
  std::uint32_t bricks_;
};

}  // namespace palpate
