// SPDX-License-Identifier: Apache-2.0
#include "apps/window/theme.hpp"

#include <imgui.h>

namespace palpate {

void applyTheme(bool dark, double scale) {
  ImGuiStyle style;
  if (dark) {
    ImGui::StyleColorsDark(&style);
  } else {
    ImGui::StyleColorsLight(&style);
  }
  style.WindowRounding = 0;
  style.FrameRounding = 3;
  style.GrabRounding = 3;
  style.WindowBorderSize = 0;
  style.FramePadding = {7, 4};
  style.ItemSpacing = {8, 6};
  style.WindowPadding = {10, 10};
  style.ScaleAllSizes(static_cast<float>(scale));
  // Panels are opaque: what lies behind them is not drawn.
  style.Colors[ImGuiCol_WindowBg] = dark ? ImVec4(0.11F, 0.12F, 0.13F, 1) : ImVec4(0.95F, 0.95F, 0.96F, 1);
  style.Colors[ImGuiCol_TextDisabled] = dark ? ImVec4(0.62F, 0.63F, 0.64F, 1) : ImVec4(0.36F, 0.37F, 0.38F, 1);
  ImGui::GetStyle() = style;
}

const float (&background(bool dark) noexcept)[3] {
  static constexpr float kDark[3] = {0.07F, 0.075F, 0.08F}, kLight[3] = {0.86F, 0.87F, 0.88F};
  return dark ? kDark : kLight;
}

const OverlayColours& overlayColours() noexcept {
  static constexpr OverlayColours kColours = {IM_COL32(0, 158, 115, 255), IM_COL32(240, 228, 66, 255),
                                              IM_COL32(213, 94, 0, 255), IM_COL32(86, 180, 233, 220),
                                              IM_COL32(0, 0, 0, 160)};
  return kColours;
}

}  // namespace palpate
