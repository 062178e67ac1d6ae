// SPDX-License-Identifier: Apache-2.0
// engine/plan/plan.hpp: turns a scene into the passes and buffers that it needs, and no others. Any thread; no cost.
//
// The plan also says what was left out and, once the volume is known, how much memory that saved. `palpate plan SCENE`
// prints it; `palpate touch` keeps it in summary.json.
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
  std::vector<FilterSpec> filters;  // make the field that is felt from the volume; empty: the volume itself is felt
  std::string filter_words;         // the same in words
  bool gradient_all = false;        // gradients of every brick, not only of those that the isosurface needs
  GradientOperator gradient;
  bool half_samples = false;  // samples are stored as halves, not as floats
  bool edits = false;         // the tool edits, so the engine keeps what edits need
  bool draws = false;         // view.png is drawn
  bool meshes = false;        // a triangle mesh of the isosurface is made, for an algorithm that touches one
  std::size_t objects = 0;    // solid objects beside the volume
  std::string effects;        // names of the contact effects; empty: none

  [[nodiscard]] bool has(Pass pass) const noexcept;
};

// Throws Error(kBadInput) for invalid filters or an unknown gradient operator.
// `needs_mesh`: the scene's algorithm touches a mesh of the isosurface (AlgorithmNeeds::isosurface_mesh).
[[nodiscard]] Plan makePlan(const Scene& scene, bool needs_mesh = false);

// Figures for planLines(), known once the engine has computed the bounds of every brick.
struct PlanFacts {
  std::size_t bricks = 0;           // in the whole domain
  std::size_t stored_bricks = 0;    // bricks of the volume that are not constant
  std::size_t filtered_bricks = 0;  // bricks of the filtered field that are not constant
  std::size_t gradient_bricks = 0;  // bricks with gradients
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
