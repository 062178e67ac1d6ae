// SPDX-License-Identifier: Apache-2.0
// base/portion_size.hpp: how many bricks to work on at a time, when a brick may take a microsecond or a tenth of a
// second. One thread; no cost.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace palpate {

// Begins small, and goes for `target_s` a portion [s]. kTarget_s suits a submission to a GPU: work can be cancelled and
// its progress told in time, no driver times out, and the cost of submitting (some 50 us) is negligible.
class PortionSize {
 public:
  static constexpr double kTarget_s = 0.1;     // [s]
  static constexpr std::uint32_t kFirst = 64;  // bricks of which nothing is known yet
  static constexpr double kMostGrowth = 4;     // from one to the next

  explicit PortionSize(std::uint32_t most, double target_s = kTarget_s) noexcept
      : most_(most), target_s_(target_s), bricks_(std::min(kFirst, most)) {}

  [[nodiscard]] std::uint32_t bricks() const noexcept { return bricks_; }  // 1 to `most`
  // The last portion had so many and took so long.
  void took(std::uint32_t bricks, double seconds) noexcept {
    const double share = target_s_ / std::max(seconds, 1e-9);
    const double next = std::floor(static_cast<double>(bricks) * std::min(share, kMostGrowth));
    bricks_ = static_cast<std::uint32_t>(std::clamp(next, 1.0, static_cast<double>(most_)));
  }

 private:
  std::uint32_t most_;
  double target_s_;
  std::uint32_t bricks_;
};

}  // namespace palpate
