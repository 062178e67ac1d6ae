// SPDX-License-Identifier: Apache-2.0
// engine/edit/lower_edit.hpp: edit commands in the form that kernels read (shaders/edit.layout.h): floats, in the
// lattice's axes, counted from a voxel near the brush. Thread: any. Cost: nothing but a stamp's copy.
#pragma once

#include <span>
#include <vector>

#include "engine/edit/brush_profile.hpp"
#include "engine/edit/edit_command.hpp"
#include "shaders/edit.layout.h"

namespace palpate {

struct LoweredEdits {
  std::vector<layout::EditCommand> commands;
  std::vector<float> stamps;  // their distances, one stamp after another; each once, however many commands use it
};

inline constexpr std::size_t kMaxCommands = 4096;  // in one apply()

// Throws as checkEdit does, and for no commands or more than kMaxCommands.
[[nodiscard]] LoweredEdits lowerEdits(std::span<const EditCommand> commands, const Vec3i& size, const Lattice& lattice,
                                      const BrushProfile& profile);

[[nodiscard]] layout::uint layoutKind(EditKind kind) noexcept;  // EDIT_...

// What kernels and twin are handed beside the commands, rounded to float once.
struct EditScale {
  std::array<float, 3> h;      // spacing [m]
  std::array<float, 3> blur;   // share of each neighbour along an axis: heat flow's largest stable step for all axes
  std::array<float, 3> inv_h;  // [1/m]
};
[[nodiscard]] EditScale editScale(const Vec3& spacing_m);

}  // namespace palpate
