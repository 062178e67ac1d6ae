// SPDX-License-Identifier: Apache-2.0
#include "engine/files/dicom_upright.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "engine/field/raw_values.hpp"
#include "engine/files/dicom_values.hpp"

namespace palpate {
namespace {

// Positions in files are rounded. So a place this far outside a slice is still on its edge [pixel].
constexpr double kEdge = 1e-3;
// Sums of doubles: a place this close to a pixel is that pixel's, and its neighbours do not count [pixel].
constexpr double kSamePlace = 1e-6;

// First and last whole pixel of the slices together, along columns (0) or rows (1).
std::pair<std::int64_t, std::int64_t> extent(const DicomSeries& series, std::size_t axis, std::size_t pixels) {
  double low = 0;
  double high = 0;
  for (const DicomSlice& slice : series) {
    low = std::min(low, slice.aside_px[axis]);
    high = std::max(high, slice.aside_px[axis]);
  }
  return {std::llround(std::floor(low + kEdge)),
          static_cast<std::int64_t>(pixels) - 1 + std::llround(std::ceil(high - kEdge))};
}

// The two pixels of a row or column between which a place lies, and the weight of the second.
struct Between {
  std::array<std::int64_t, 2> pixel = {0, 0};
  double weight = 0;
  bool inside = false;
};
Between between(double place, std::int64_t pixels) {
  const auto last = static_cast<double>(pixels - 1);
  Between found;
  if (!(place >= -kEdge && place <= last + kEdge)) return found;
  place = std::clamp(place, 0.0, last);
  if (std::abs(place - std::round(place)) <= kSamePlace) place = std::round(place);
  const auto first = static_cast<std::int64_t>(place);
  found.pixel = {first, std::min(first + 1, pixels - 1)};
  found.weight = place - static_cast<double>(first);
  found.inside = true;
  return found;
}

float interpolated(std::span<const float> slice, std::int64_t columns, const Between& x, const Between& y) {
  if (!x.inside || !y.inside) return noValue();
  double sum = 0;
  bool beyond = false;
  for (std::size_t b = 0; b < 2; ++b) {
    for (std::size_t a = 0; a < 2; ++a) {
      const double weight = (a == 0 ? 1 - x.weight : x.weight) * (b == 0 ? 1 - y.weight : y.weight);
      if (weight == 0) continue;
      const float value = slice[static_cast<std::size_t>(y.pixel[b] * columns + x.pixel[a])];
      if (isNoValue(value)) return noValue();
      beyond = beyond || std::isnan(value);
      sum += weight * static_cast<double>(value);
    }
  }
  return beyond ? beyondFloat() : static_cast<float>(sum);
}

}  // namespace

UprightBlock uprightBlockOf(const DicomSeries& series, const Lattice& lowest) {
  const auto [left, right] = extent(series, 0, series[0].columns());
  const auto [top, bottom] = extent(series, 1, series[0].rows());
  UprightBlock block{lowest, right - left + 1, bottom - top + 1, left, top};
  block.lattice.origin_W = lowest.toWorld(Vec3(static_cast<double>(left), static_cast<double>(top), 0));
  return block;
}

std::vector<float> resampledUpright(const std::vector<float>& values, const DicomSeries& series,
                                    const UprightBlock& block) {
  const auto columns = static_cast<std::int64_t>(series[0].columns());
  const auto rows = static_cast<std::int64_t>(series[0].rows());
  const auto pixels = static_cast<std::size_t>(columns * rows);
  std::vector<float> upright;
  upright.reserve(static_cast<std::size_t>(block.columns * block.rows) * series.size());
  for (std::size_t k = 0; k < series.size(); ++k) {
    const std::span<const float> slice = std::span(values).subspan(k * pixels, pixels);
    for (std::int64_t j = 0; j < block.rows; ++j) {
      const Between y = between(static_cast<double>(j + block.first_row) - series[k].aside_px[1], rows);
      for (std::int64_t i = 0; i < block.columns; ++i) {
        const Between x = between(static_cast<double>(i + block.first_column) - series[k].aside_px[0], columns);
        upright.push_back(interpolated(slice, columns, x, y));
      }
    }
  }
  return upright;
}

}  // namespace palpate
