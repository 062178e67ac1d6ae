// SPDX-License-Identifier: Apache-2.0
#include "apps/window/panels.hpp"

#include <algorithm>

#include <imgui.h>

namespace palpate {
namespace {

constexpr float kLeft = 300, kRight = 290, kBottom = 86;  // [pixel] at 1x
constexpr ImGuiWindowFlags kPanel = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                                    ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoBringToFrontOnFocus |
                                    ImGuiWindowFlags_NoFocusOnAppearing;

template <typename Content>
void panel(const char* name, const ImVec2& at, const ImVec2& size, ImGuiWindowFlags more, const Content& content) {
  ImGui::SetNextWindowPos(at);
  ImGui::SetNextWindowSize(size);
  if (ImGui::Begin(name, nullptr, kPanel | more)) content();
  ImGui::End();
}

}  // namespace

PictureArea showPanels(WindowModel& model, double scale) {
  const ImVec2 all = ImGui::GetIO().DisplaySize;
  const auto by = static_cast<float>(scale);
  const float left = std::min(kLeft * by, all.x / 3), right = std::min(kRight * by, all.x / 3);
  const float bottom = std::min(kBottom * by, all.y / 3);
  panel("left", ImVec2(0, 0), ImVec2(left, all.y - bottom), 0, [&] {
    showFileSection(model);
    showBrushSection(model);
    showSurfaceSection(model);
    showViewSection(model);
    showCutsSection(model);
  });
  panel("right", ImVec2(all.x - right, 0), ImVec2(right, all.y - bottom), 0, [&] {
    showTouchSection(model);
    showEditsSection(model);
    showMeasuredSection(model);
    showFaultsSection(model);
    showPlanSection(model);
  });
  // Nothing in it can be changed, so the keyboard does not go there.
  panel("status", ImVec2(0, all.y - bottom), ImVec2(all.x, bottom), ImGuiWindowFlags_NoNavFocus,
        [&] { showStatus(model); });
  showLeaveQuestion(model);
  showOverwriteQuestion(model);
  return {left, 0, std::max(1.0F, all.x - left - right), std::max(1.0F, all.y - bottom)};
}

}  // namespace palpate
