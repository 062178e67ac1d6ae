// SPDX-License-Identifier: Apache-2.0
#include "apps/window/panel_parts.hpp"

namespace palpate {
namespace {

constexpr float kLabel = 6.5F;  // width of a label [font size]

}  // namespace

ForceWords forceWordsOf(const WindowModel& model) {
  const SculptSide& session = model.session;
  return forceWords(model.tick, model.state.running ? "" : model.state.missing_servo,
                    session.settings().parameters.isovalue,
                    session.deviceIsHeld() ? std::optional(model.state.force_off) : std::nullopt);
}

bool section(const char* title, bool open_at_first) {
  return ImGui::CollapsingHeader(title, open_at_first ? ImGuiTreeNodeFlags_DefaultOpen : 0);
}

void tip(const std::string& text) {
  if (!ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(ImGui::GetFontSize() * 22);
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

void leaveRoomForLabel() {
  ImGui::SetNextItemWidth(-ImGui::GetFontSize() * kLabel);
}

bool slider(const char* label, double& value, double low, double high, double unit, const char* form,
            bool logarithmic) {
  auto shown = static_cast<float>(value / unit);
  leaveRoomForLabel();
  const bool moved =
      ImGui::SliderFloat(label, &shown, static_cast<float>(low / unit), static_cast<float>(high / unit), form,
                         (logarithmic ? ImGuiSliderFlags_Logarithmic : 0) | ImGuiSliderFlags_AlwaysClamp);
  if (moved) value = shown * unit;
  return moved;
}

bool shareSlider(const char* label, double& share) {
  return slider(label, share, 0, 1, 0.01, "%.0f %%");
}

ImVec2 inRow(int buttons) {
  const float all = ImGui::GetWindowContentRegionMax().x - ImGui::GetWindowContentRegionMin().x;
  const auto count = static_cast<float>(buttons);
  return {(all - (count - 1) * ImGui::GetStyle().ItemSpacing.x) / count, 0};
}

void mutedText(const std::string& text) {
  ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
  ImGui::TextWrapped("%s", text.c_str());
  ImGui::PopStyleColor();
}

}  // namespace palpate
