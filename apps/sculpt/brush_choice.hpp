// SPDX-License-Identifier: Apache-2.0
// apps/sculpt/brush_choice.hpp: the brush that a person has chosen in the window, and what keys make of it for a while.
// Any thread; no cost.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "engine/session/tool_brush.hpp"

namespace palpate {

enum class BrushKind { kDrill, kAdd, kSmooth, kInflate, kFlatten };

struct BrushEntry {
  BrushKind kind;
  const char* name;     // "Drill"
  const char* inverse;  // what Ctrl makes of it: "Add"; empty: the same
  const char* help;     // one line
};
[[nodiscard]] std::span<const BrushEntry> brushes() noexcept;
[[nodiscard]] const BrushEntry& brushEntry(BrushKind kind) noexcept;

struct BrushChoice {
  BrushKind kind = BrushKind::kDrill;
  double radius_m = 3e-3;
  double strength = 0.5;                // 0 to 1: how fast it works [-]
  std::optional<int> mirror_axis = {};  // of the volume's lattice, 0 to 2

  static constexpr double kLeastRadius_m = 1e-5, kMostRadius_m = 0.1;
  void scaleRadius(double factor) noexcept;  // within these
  void addStrength(double change) noexcept;  // within 0.01 to 1
};

// As Blender's sculpt mode has them: Ctrl turns a brush into its opposite, Shift smooths.
struct BrushKeys {
  bool inverts = false, smooths = false;
};
[[nodiscard]] ToolBrushSpec toolBrush(const BrushChoice& choice, const BrushKeys& keys) noexcept;

// What a person has to know of a brush that they have just picked or resized (fineBrushWarning()), once.
class BrushAdvice {
 public:
  // To be called in every frame. `rests`: nobody is changing the brush, as one drags a slider. "Drill: its radius of
  // ..."; empty: the brush is as at the last call that rested, or there is nothing to tell.
  [[nodiscard]] std::string take(const BrushChoice& choice, const Lattice& lattice, bool rests);

 private:
  std::optional<std::pair<BrushKind, double>> seen_;  // kind and radius [m]
};

}  // namespace palpate
