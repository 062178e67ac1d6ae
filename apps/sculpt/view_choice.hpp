// SPDX-License-Identifier: Apache-2.0
// apps/sculpt/view_choice.hpp: what a person has chosen to see of a volume: cuts, slices, a second surface. Any thread;
// no cost.
#pragma once

#include <array>
#include <optional>

#include "apps/render/render_request.hpp"
#include "base/lattice.hpp"
#include "engine/draw/draw_style.hpp"

namespace palpate {

// A plane across an axis of the world, at a share of the volume's extent along it: 0 where it begins, 1 where it ends.
struct CutChoice {
  bool on = false;
  double share = 0.5;
  bool keeps_low = false;  // what lies towards the axis' beginning is drawn, not what lies towards its end
};

struct SliceChoice {
  bool on = false;
  double share = 0.5;
};

struct ViewChoice {
  bool occlusion = DrawStyle{}.occlusion;
  std::array<CutChoice, 3> cuts = {};  // across x, y, z
  std::array<SliceChoice, 3> slices = {};
  SliceRange slice_range = {};            // densities that slices show black and white
  std::optional<double> second_isovalue;  // of a translucent surface before the first; empty: none [density]
  double second_opacity = DrawStyle{}.other_opacity;
};

inline constexpr std::array<const char*, 3> kWorldAxes = {"left", "back", "up"};  // LPS: where x, y and z point

// Throws Error(kBadInput) where the cuts leave nothing of the volume, and as checkStyle(). `size` [voxel].
[[nodiscard]] DrawStyle styleOf(const ViewChoice& choice, const Lattice& lattice, const Vec3i& size);

}  // namespace palpate
