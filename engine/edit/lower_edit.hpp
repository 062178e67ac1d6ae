// SPDX-License-Identifier: Apache-2.0
// engine/edit/lower_edit.hpp: lowers edit commands to the form that kernels read (shaders/edit.layout.h): floats [m]
// along the lattice's axes, relative to a voxel near the brush. Thread: any. Cost: a copy of each stamp; next to
// nothing else.
#pragma once

#include <span>
#include <vector>

#include "engine/edit/brush_profile.hpp"
#include "engine/edit/edit_command.hpp"
#include "shaders/edit.layout.h"

namespace palpate {

struct LoweredEdits {
  std::vector<layout::EditCommand> commands;
  std::vector<float> stamps;  // distances of all stamps, one after another; a stamp used twice is stored once
};

inline constexpr std::size_t kMaxCommands = 4096;  // in one Editor::apply()

// Throws Error(kBadInput) as checkEdit() does, and for an empty list or more than kMaxCommands.
[[nodiscard]] LoweredEdits lowerEdits(std::span<const EditCommand> commands, const Vec3i& size, const Lattice& lattice,
                                      const BrushProfile& profile);

[[nodiscard]] layout::uint layoutKind(EditKind kind) noexcept;  // EDIT_... of shaders/edit.layout.h

[[nodiscard]] layout::EditScale editScale(const Vec3& spacing_m);

}  // namespace palpate
