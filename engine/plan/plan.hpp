// SPDX-License-Identifier: Apache-2.0
// engine/plan/plan.hpp: turns a request to the engine into the passes and buffers that the request needs, and no
// others. Any thread; no cost.
//
// The plan also says what was left out and, once the volume is known, how much memory that saved.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/filter/filter_spec.hpp"
#include "engine/gradient/gradient_operator.hpp"

namespace palpate {

enum class Pass { kUpload, kFilter, kBrickBounds, kSmoothing, kGradient, kWindow };

[[nodiscard]] const char* passName(Pass pass) noexcept;

// Samples along an edge of the servo's window [voxel]. With fewer the tool could leave it between two windows; for more
// there is no room.
inline constexpr int kLeastWindowEdge = 8, kMostWindowEdge = 32;

// What an engine shall do. Nothing else is computed or kept.
struct EngineRequest {
  std::string filter = {};    // chain of filters before the field is felt: "gaussian:0.8mm"; empty: none
  bool distance = false;      // the signed distance from that field's isosurface is felt
  bool gradient_all = false;  // gradients of every brick, not only of those that the isosurface needs
  std::string gradient_operator = "central";  // engine/gradient/gradient_operator.hpp
  bool half_samples = false;                  // samples are stored as halves, not as floats
  int window_edge = kMostWindowEdge;          // of the servo's window [voxel]
  bool edits = false;                         // the volume will be edited, so what edits need is kept
  bool other_isovalues = false;               // the isovalue may change, so what gradients need is kept
  bool draws = false;                         // the isosurface will be drawn
  // Gradients of a brick are computed when a window first reaches it, not all at the start. Only where nothing else
  // asks for them: see Plan::gradientsAsNeeded().
  bool gradients_as_needed = false;
};

struct Plan {
  EngineRequest request;
  std::vector<Pass> passes;         // in order of execution
  std::vector<FilterSpec> filters;  // make the field that is felt from the volume; empty: the volume itself is felt
  std::string filter_words;         // the same in words
  GradientOperator gradient;

  [[nodiscard]] bool has(Pass pass) const noexcept;
  // True if the request says so and nothing changes samples or needs them all: no edits, no other isovalue, not the
  // gradients of every brick, no smoothed field, which would have to be kept.
  [[nodiscard]] bool gradientsAsNeeded() const noexcept;
};

// Throws Error(kBadInput) for invalid filters, an unknown gradient operator, and a window's edge out of range.
[[nodiscard]] Plan makePlan(const EngineRequest& request);

// Figures for planLines(), known once the engine has computed the bounds of every brick.
struct PlanFacts {
  std::size_t bricks = 0;           // in the whole domain
  std::size_t stored_bricks = 0;    // bricks of the volume that are not constant
  std::size_t filtered_bricks = 0;  // bricks of the filtered field that are not constant
  std::size_t gradient_bricks = 0;  // bricks that have gradients, or get them when a window reaches them
};

struct PlanLine {
  bool done = false;  // false: left out
  std::string what;   // "gradient of 1234 of 13824 bricks"
  std::string why;
  std::uint64_t saved_bytes = 0;
};

// A line for each pass and buffer, done or left out.
[[nodiscard]] std::vector<PlanLine> planLines(const Plan& plan, const PlanFacts& facts);

}  // namespace palpate
