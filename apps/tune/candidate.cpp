// SPDX-License-Identifier: Apache-2.0
#include "apps/tune/candidate.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {

Candidate candidateOf(const Scene& scene) {
  return {scene.gradient_operator, scene.filter, scene.samples, scene.plane_renewal_ticks, scene.window_edge};
}

Scene withCandidate(Scene scene, const Candidate& candidate) {
  scene.gradient_operator = candidate.gradient_operator;
  scene.filter = candidate.filter;
  scene.samples = candidate.samples;
  scene.plane_renewal_ticks = candidate.n;
  scene.window_edge = candidate.window_edge;
  return scene;
}

const char* axisName(Axis axis) noexcept {
  switch (axis) {
    case Axis::kOperator:
      return "operator";
    case Axis::kFilter:
      return "filter";
    case Axis::kSamples:
      return "storage";
    case Axis::kN:
      return "n";
    case Axis::kWindow:
      return "window";
  }
  return "?";
}

std::string valueOn(Axis axis, const Candidate& candidate) {
  switch (axis) {
    case Axis::kOperator:
      return candidate.gradient_operator;
    case Axis::kFilter:
      return candidate.filter.empty() ? "none" : candidate.filter;
    case Axis::kSamples:
      return candidate.samples;
    case Axis::kN:
      return std::to_string(candidate.n);
    case Axis::kWindow:
      return std::to_string(candidate.window_edge);
  }
  return "?";
}

void keepWorse(Trial& trial, const Trial& again) {
  if (trial.impossible.empty()) trial.impossible = again.impossible;
  if (std::isnan(again.error_N) || again.error_N > trial.error_N) trial.error_N = again.error_N;
  trial.contact_share = std::min(trial.contact_share, again.contact_share);
  trial.faulty_ticks = std::max(trial.faulty_ticks, again.faulty_ticks);
}

bool differOnlyOn(Axis axis, const Candidate& a, const Candidate& b) {
  return std::ranges::all_of(kAxes,
                             [&](Axis other) { return (valueOn(other, a) == valueOn(other, b)) != (other == axis); });
}

}  // namespace palpate
