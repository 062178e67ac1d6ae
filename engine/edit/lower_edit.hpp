// SPDX-License-Identifier: Apache-2.0
// engine/edit/lower_edit.hpp: lowers edit commands to the form that kernels read (shaders/edit.layout.h): floats [m]
// along the lattice's axes, relative to a voxel near the brush. Thread: any. Cost: next to nothing, but for copying
// stamps.
#pragma once

#include <span>
#include <vector>

#include "engine/edit/brush_profile.hpp"
#include "engine/edit/edit_command.hpp"
#include "shaders/edit.layout.h"

namespace palpate {

struct LoweredEdits {
  std::vector<layout::EditCommand> commands;
  std::vector<float> stamps;  // distances of the stamps, one after another; a stamp used twice is there once
};

inline constexpr std::size_t kMaxCommands = 4096;  // in one Editor::apply()

// Throws Error(kBadInput) as checkEdit does, for an empty list, and for more than kMaxCommands.
[[nodiscard]] LoweredEdits lowerEdits(std::span<const EditCommand> commands, const Vec3i& size, const Lattice& lattice,
                                      const BrushProfile& profile);

[[nodiscard]] layout::uint layoutKind(EditKind kind) noexcept;  // EDIT_...

[[nodiscard]] layout::EditScale editScale(const Vec3& spacing_m);

}  // namespace palpate
