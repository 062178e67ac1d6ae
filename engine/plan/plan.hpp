// SPDX-License-Identifier: Apache-2.0
// engine/plan/plan.hpp: scene -> the passes and buffers that it needs, and no others. Any thread; no cost.
//
// What a scene does not ask for is not there; the plan says what was left out, and, once the volume is known, what that
// saved. `palpate plan SCENE` prints it; `palpate touch` keeps it in summary.json.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/filter/filter_spec.hpp"
#include "engine/gradient/gradient_operator.hpp"
#include "engine/plan/scene.hpp"

namespace palpate {

enum class Pass { kUpload, kFilter, kBrickBounds, kSmoothing, kGradient, kWindow, kIsosurface };

[[nodiscard]] const char* passName(Pass pass) noexcept;

struct Plan {
  std::vector<Pass> passes;         // in order of execution
  std::vector<FilterSpec> filters;  // from the volume to the field that is felt; empty: the volume itself
  std::string filter_words;         // the same in words
  bool gradient_all = false;        // gradients of every brick, not of those alone that the isosurface needs
  GradientOperator gradient;        // how they are taken
  bool half_samples = false;        // stored as halves, not as floats
  bool edits = false;               // the tool edits: what following edits needs is kept
  bool draws = false;
  bool meshes = false;      // the isosurface becomes a triangle mesh, for an algorithm that touches one
  std::size_t objects = 0;  // beside the volume
  std::string effects;      // names of the contact effects; empty: none

  [[nodiscard]] bool has(Pass pass) const noexcept;
};

// Throws Error(kBadInput): filters that cannot be meant; an operator that is none.
// `needs_mesh`: the scene's algorithm touches a mesh of the isosurface (AlgorithmNeeds::isosurface_mesh).
[[nodiscard]] Plan makePlan(const Scene& scene, bool needs_mesh = false);

// What is known of the volume once its bounds are: for the words below.
struct PlanFacts {
  std::size_t bricks = 0;           // of the whole domain
  std::size_t stored_bricks = 0;    // that are not constant
  std::size_t filtered_bricks = 0;  // of the filtered field, that are not constant
  std::size_t gradient_bricks = 0;  // that got gradients
  std::size_t mesh_triangles = 0;   // of the isosurface; 0: not extracted (yet)
};

struct PlanLine {
  bool done = false;  // false: left out
  std::string what;   // "gradient of 1234 of 13824 bricks"
  std::string why;
  std::uint64_t saved_bytes = 0;
};

[[nodiscard]] std::vector<PlanLine> planLines(const Plan& plan, const PlanFacts& facts);

}  // namespace palpate
