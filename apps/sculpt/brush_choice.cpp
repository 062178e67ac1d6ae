// SPDX-License-Identifier: Apache-2.0
#include "apps/sculpt/brush_choice.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "engine/edit/brush_profile.hpp"

namespace palpate {
namespace {

constexpr BrushEntry kBrushes[] = {
    {BrushKind::kDrill, "Drill", "Add", "takes away what it touches, faster the harder it is pressed"},
    {BrushKind::kAdd, "Add", "Drill", "builds up material around the tool"},
    {BrushKind::kSmooth, "Smooth", "", "evens out what is rough"},
    {BrushKind::kInflate, "Inflate", "Deflate", "moves the surface outwards"},
    {BrushKind::kFlatten, "Flatten", "", "turns the surface into the plane where the stroke began"},
};

// At full strength and a newton a brush has 1 - 1/e of its full effect after this time.
constexpr double kTimeAtFullStrength_s = 0.05;

EditKind editKind(BrushKind kind, bool inverts) noexcept {
  switch (kind) {
    case BrushKind::kDrill:
      return inverts ? EditKind::kAdd : EditKind::kRemove;
    case BrushKind::kAdd:
      return inverts ? EditKind::kRemove : EditKind::kAdd;
    case BrushKind::kSmooth:
      return EditKind::kSmooth;
    case BrushKind::kInflate:
      return inverts ? EditKind::kDeflate : EditKind::kInflate;
    case BrushKind::kFlatten:
      return EditKind::kFlatten;
  }
  return EditKind::kRemove;
}

}  // namespace

std::span<const BrushEntry> brushes() noexcept {
  return kBrushes;
}

const BrushEntry& brushEntry(BrushKind kind) noexcept {
  return *std::find_if(std::begin(kBrushes), std::end(kBrushes), [&](const BrushEntry& b) { return b.kind == kind; });
}

void BrushChoice::scaleRadius(double factor) noexcept {
  radius_m = std::clamp(radius_m * factor, kLeastRadius_m, kMostRadius_m);
}

void BrushChoice::addStrength(double change) noexcept {
  strength = std::clamp(strength + change, 0.01, 1.0);
}

// The strength is a rate, so what a stroke does depends on how long and how hard it is pressed, not on how often edits
// are made. The rim of the brush fades, so that a stroke leaves no edge.
ToolBrushSpec toolBrush(const BrushChoice& choice, const BrushKeys& keys) noexcept {
  ToolBrushSpec spec;
  spec.brush.kind = keys.smooths ? EditKind::kSmooth : editKind(choice.kind, keys.inverts);
  spec.brush.radius_m = choice.radius_m;
  spec.brush.strength = 1;
  spec.brush.falloff = 0.5;
  spec.rate_per_Ns = choice.strength / kTimeAtFullStrength_s;
  spec.mirror_axis = choice.mirror_axis;
  return spec;
}

std::string BrushAdvice::take(const BrushChoice& choice, const Lattice& lattice, bool rests) {
  const std::pair now(choice.kind, choice.radius_m);
  if (!rests || seen_ == now) return "";
  seen_ = now;
  constexpr double kMostIsMissing = 0.5;  // less than that a person sees
  const std::string words = fineBrushWarning(toolBrush(choice, {}).brush, lattice, Strokes::kMany, kMostIsMissing);
  return words.empty() ? "" : fmt::format("{}: {}", brushEntry(choice.kind).name, words);
}

}  // namespace palpate
