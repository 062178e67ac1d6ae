// SPDX-License-Identifier: Apache-2.0
#include "engine/field/otsu.hpp"

namespace palpate {
namespace {

// Running sums over bins. In them, a class contributes (sum of bins)^2 / count to the variance between classes.
class ClassSums {
 public:
  explicit ClassSums(const Histogram& histogram) : count_(1, 0.0), sum_(1, 0.0) {
    for (std::size_t bin = 0; bin < histogram.counts.size(); ++bin) {
      const auto voxels = static_cast<double>(histogram.counts[bin]);
      count_.push_back(count_.back() + voxels);
      sum_.push_back(sum_.back() + voxels * static_cast<double>(bin));
    }
  }

  [[nodiscard]] std::size_t bins() const { return count_.size() - 1; }

  // The contribution of a class of the bins [begin, end).
  [[nodiscard]] double share(std::size_t begin, std::size_t end) const {
    const double count = count_[end] - count_[begin];
    const double sum = sum_[end] - sum_[begin];
    return count > 0 ? sum * sum / count : 0;
  }

 private:
  std::vector<double> count_;
  std::vector<double> sum_;
};

// The threshold of a cut before `bin`. Any cut within a gap of empty bins splits the voxels in the same way, so the
// threshold is the middle of the gap. For a mask, that is half-way between its two values.
double middle(const Histogram& histogram, std::size_t bin) {
  std::size_t end = bin;
  while (end < histogram.counts.size() && histogram.counts[end] == 0) ++end;
  return histogram.low + histogram.bin_width * 0.5 * static_cast<double>(bin + end);
}

}  // namespace

double otsuThreshold(const Histogram& histogram) {
  const ClassSums sums(histogram);
  std::size_t best = 0;
  double best_share = -1;
  for (std::size_t cut = 1; cut < sums.bins(); ++cut) {
    const double share = sums.share(0, cut) + sums.share(cut, sums.bins());
    if (share <= best_share) continue;
    best_share = share;
    best = cut;
  }
  return middle(histogram, best);
}

std::pair<double, double> otsuThresholds(const Histogram& histogram) {
  const ClassSums sums(histogram);
  std::pair<std::size_t, std::size_t> best = {0, 0};
  double best_share = -1;
  for (std::size_t low = 1; low + 1 < sums.bins(); ++low) {
    for (std::size_t high = low + 1; high < sums.bins(); ++high) {
      const double share = sums.share(0, low) + sums.share(low, high) + sums.share(high, sums.bins());
      if (share <= best_share) continue;
      best_share = share;
      best = {low, high};
    }
  }
  return {middle(histogram, best.first), middle(histogram, best.second)};
}

}  // namespace palpate
