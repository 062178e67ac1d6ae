// SPDX-License-Identifier: Apache-2.0
// servo/devices/latency_histogram.hpp: how long something took, counted in classes of a factor 2^(1/4), so that
// quantiles are within 19 %. One thread adds, any thread reads; neither waits. No heap, no errors.
#pragma once

#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>

namespace palpate {

class LatencyHistogram {
 public:
  void add(std::int64_t time_ns) noexcept {
    const double classes = kPerOctave * std::log2(std::max(1.0, static_cast<double>(time_ns)));
    const auto at = std::min(kClasses - 1, static_cast<std::size_t>(classes));
    counts_[at].store(counts_[at].load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
    if (time_ns > longest_ns_.load(std::memory_order_relaxed)) longest_ns_.store(time_ns, std::memory_order_relaxed);
  }
  [[nodiscard]] std::int64_t longest_ns() const noexcept { return longest_ns_.load(std::memory_order_relaxed); }
  // The upper end of the class that holds the quantile `share` (0 to 1), or the longest if that is less; 0: nothing was
  // added [ns].
  [[nodiscard]] double quantile_ns(double share) const noexcept {
    std::int64_t all = 0;
    for (const auto& count : counts_) all += count.load(std::memory_order_relaxed);
    std::int64_t below = 0;
    for (std::size_t i = 0; i < kClasses; ++i) {
      below += counts_[i].load(std::memory_order_relaxed);
      if (below > 0 && static_cast<double>(below) >= share * static_cast<double>(all))
        return std::min(static_cast<double>(longest_ns()), std::exp2(static_cast<double>(i + 1) / kPerOctave));
    }
    return 0;
  }

 private:
  static constexpr double kPerOctave = 4;
  static constexpr std::size_t kClasses = 160;  // up to 2^40 ns, 18 minutes

  std::array<std::atomic<std::int64_t>, kClasses> counts_{};
  std::atomic<std::int64_t> longest_ns_{0};
};

}  // namespace palpate
