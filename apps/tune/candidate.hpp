// SPDX-License-Identifier: Apache-2.0
// apps/tune/candidate.hpp: what `palpate tune` chooses for a scene, and what a trial of such a choice found. Any
// thread.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "apps/scene/scene.hpp"

namespace palpate {

struct Candidate {
  std::string gradient_operator = Scene{}.gradient_operator;
  std::string filter = Scene{}.filter;  // empty: none
  std::string samples = Scene{}.samples;
  int n = Scene{}.plane_renewal_ticks;    // [tick]
  int window_edge = Scene{}.window_edge;  // [voxel]

  bool operator==(const Candidate&) const = default;
};

[[nodiscard]] Candidate candidateOf(const Scene& scene);
[[nodiscard]] Scene withCandidate(Scene scene, const Candidate& candidate);

// One of the five choices.
enum class Axis { kOperator, kFilter, kSamples, kN, kWindow };
inline constexpr Axis kAxes[] = {Axis::kOperator, Axis::kFilter, Axis::kN, Axis::kWindow, Axis::kSamples};

[[nodiscard]] const char* axisName(Axis axis) noexcept;                              // "operator"
[[nodiscard]] std::string valueOn(Axis axis, const Candidate& candidate);            // "none" for no filter
[[nodiscard]] bool differOnlyOn(Axis axis, const Candidate& a, const Candidate& b);  // and do differ there

// What was felt with a candidate.
struct Trial {
  Candidate candidate = {};
  std::string impossible = {};                                // why it could not be felt; empty: it was
  double error_N = std::numeric_limits<double>::quiet_NaN();  // p99 of the force's error; NaN: not known [N]
  double loop_us = 0;                                         // mean time of a tick with its share of the windows [us]
  std::uint64_t memory_bytes = 0;                             // on the Vulkan device, and of a mesh
  double start_ms = 0;       // from the volume in memory to the first tick, without its path [ms]
  double contact_share = 0;  // ticks in contact of the slide (of all, where there is none) whose error counts [-]
  std::int64_t faulty_ticks = 0;
};

// `trial` was felt once more: the worse of both counts in error, contact, faults and possibility. The time, memory and
// start of `trial` stay.
void keepWorse(Trial& trial, const Trial& again);

}  // namespace palpate
