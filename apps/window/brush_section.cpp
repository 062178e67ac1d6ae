// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <imgui.h>

#include "apps/window/panel_parts.hpp"
#include "apps/window/panels.hpp"
#include "base/units.hpp"

namespace palpate {

void showBrushSection(WindowModel& model) {
  if (!section("Brush")) return;
  BrushChoice& brush = model.settings.brush;
  int column = 0;
  for (const BrushEntry& entry : brushes()) {
    if (column++ % 3 != 0) ImGui::SameLine(static_cast<float>((column - 1) % 3) * ImGui::GetWindowWidth() * 0.31F + 10);
    if (ImGui::RadioButton(entry.name, brush.kind == entry.kind)) brush.kind = entry.kind;
    tip(fmt::format("{}{}{}", entry.help, *entry.inverse != '\0' ? "; Ctrl: " : "", entry.inverse));
  }
  slider("Radius", brush.radius_m, BrushChoice::kLeastRadius_m, BrushChoice::kMostRadius_m, kMetresPerMillimetre,
         "%.2f mm", true);
  tip("F, then move the mouse; or [ and ]");
  slider("Strength", brush.strength, 0.01, 1, 1, "%.2f");
  tip("How fast it works: Shift+F, then move the mouse");
  slider("Depth", model.settings.reach.depth_m, Gestures::kLeastDepth_m, Gestures::kMostDepth_m, kMetresPerMillimetre,
         "%.2f mm", true);
  tip("How far the mouse presses the tool below the surface; the wheel changes it during a stroke");
  int mirror = brush.mirror_axis ? *brush.mirror_axis + 1 : 0;
  leaveRoomForLabel();
  if (ImGui::Combo("Mirror", &mirror, "none\0X\0Y\0Z\0"))
    brush.mirror_axis = mirror == 0 ? std::nullopt : std::optional(mirror - 1);
  tip("Repeats strokes on the other side of the volume's middle (keys X, Y, Z)");
}

}  // namespace palpate
