// SPDX-License-Identifier: Apache-2.0
// base/portion_size.hpp: how many bricks to work on at a time, so that a portion takes a set time.
//
// A brick may take a microsecond or a tenth of a second. One thread. No cost.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace palpate {

// Begins with a small portion and aims at `target_s` for each [s]. kTarget_s suits a submission to a GPU: work can be
// cancelled and shows its progress, no driver times out, and the cost of submitting (some 50 us) is negligible.
class PortionSize {
 public:
  static constexpr double kTarget_s = 0.1;     // [s]
  static constexpr std::uint32_t kFirst = 64;  // size of the first portion [brick]
  static constexpr double kMostGrowth = 4;     // from one portion to the next [-]

  explicit PortionSize(std::uint32_t most, double target_s = kTarget_s) noexcept
      : most_(most), target_s_(target_s), bricks_(std::min(kFirst, most)) {}

  [[nodiscard]] std::uint32_t bricks() const noexcept { return bricks_; }  // 1 to `most`
  // Reports the last portion: its size and its time [s].
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
