// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/path.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/formatted.hpp"

namespace palpate {
namespace {

[[noreturn]] void refusePath(const std::string& reason, const std::string& remedy) {
  throw Error(Error::Code::kBadInput, "path", reason, remedy);
}

void check(const std::vector<double>& times_s, const std::vector<Vec3>& points_W) {
  if (points_W.empty() || times_s.size() != points_W.size()) {
    refusePath(formatted("{} times for {} points", times_s.size(), points_W.size()), "give one time for each point");
  }
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    if (!std::isfinite(times_s[i]) || !points_W[i].allFinite()) {
      refusePath(formatted("point {} is not a number", i), "correct or remove it");
    }
    if (i > 0 && times_s[i] <= times_s[i - 1]) {
      refusePath(formatted("time {} s of point {} is not after {} s", times_s[i], i, times_s[i - 1]),
                 "sort the points by time and remove repeated times");
    }
  }
}

}  // namespace

SampledPath::SampledPath(std::vector<double> times_s, std::vector<Vec3> points_W, Interpolation interpolation)
    : times_s_(std::move(times_s)), points_W_(std::move(points_W)) {
  check(times_s_, points_W_);
  const double start_s = times_s_.front();
  for (double& time_s : times_s_) time_s -= start_s;
  if (interpolation == Interpolation::kLinear || points_W_.size() < 2) return;
  for (std::size_t i = 0; i < points_W_.size(); ++i) tangents_W_.push_back(tangent(i));
}

// Slope of the parabola through a point and its two neighbours; at the ends the slope of the chord.
Vec3 SampledPath::tangent(std::size_t i) const noexcept {
  const auto chord = [&](std::size_t a) {
    return Vec3((points_W_[a + 1] - points_W_[a]) / (times_s_[a + 1] - times_s_[a]));
  };
  if (i == 0) return chord(0);
  if (i + 1 == points_W_.size()) return chord(i - 1);
  const double before_s = times_s_[i] - times_s_[i - 1];
  const double after_s = times_s_[i + 1] - times_s_[i];
  return (chord(i - 1) * after_s + chord(i) * before_s) / (before_s + after_s);
}

Vec3 SampledPath::position(double time_s) const noexcept {
  if (!(time_s > 0)) return points_W_.front();
  if (time_s >= times_s_.back()) return points_W_.back();
  const auto next = std::upper_bound(times_s_.begin(), times_s_.end(), time_s);
  const auto b = static_cast<std::size_t>(next - times_s_.begin());
  const std::size_t a = b - 1;
  const double span_s = times_s_[b] - times_s_[a];
  const double u = (time_s - times_s_[a]) / span_s;
  if (tangents_W_.empty()) return points_W_[a] + (points_W_[b] - points_W_[a]) * u;
  const double v = 1 - u;
  return points_W_[a] * (v * v * (1 + 2 * u)) + points_W_[b] * (u * u * (1 + 2 * v)) +
         (tangents_W_[a] * v - tangents_W_[b] * u) * (u * v * span_s);
}

}  // namespace palpate
