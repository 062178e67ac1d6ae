// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <imgui.h>

#include "apps/window/panel_parts.hpp"
#include "apps/window/panels.hpp"

namespace palpate {
namespace {

// The histogram, with a logarithmic height, and a line at the isovalue. A click or drag in it chooses another.
std::optional<double> histogram(const Histogram& of, double isovalue) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const ImVec2 size(ImGui::GetContentRegionAvail().x, ImGui::GetFontSize() * 4);
  ImGui::InvisibleButton("histogram", size);
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  draw.AddRectFilled(at, ImVec2(at.x + size.x, at.y + size.y), ImGui::GetColorU32(ImGuiCol_FrameBg));
  double most = 1;
  for (const std::uint64_t count : of.counts) most = std::max(most, std::log1p(static_cast<double>(count)));
  const double width = of.bin_width * static_cast<double>(of.counts.size());
  const float bin = size.x / static_cast<float>(of.counts.size());
  for (std::size_t i = 0; i < of.counts.size(); ++i) {
    const auto height = static_cast<float>(std::log1p(static_cast<double>(of.counts[i])) / most * size.y);
    const float x = at.x + static_cast<float>(i) * bin;
    draw.AddRectFilled(ImVec2(x, at.y + size.y - height), ImVec2(x + std::max(1.0F, bin), at.y + size.y),
                       ImGui::GetColorU32(ImGuiCol_PlotHistogram, 0.55F));
  }
  const auto line = at.x + static_cast<float>((isovalue - of.low) / width) * size.x;
  draw.AddLine(ImVec2(line, at.y), ImVec2(line, at.y + size.y), ImGui::GetColorU32(ImGuiCol_Text), 2);
  if (!ImGui::IsItemActive()) return std::nullopt;
  const double share = std::clamp((ImGui::GetIO().MousePos.x - at.x) / size.x, 0.0F, 1.0F);
  return of.low + share * width;
}

std::optional<double> preset(const std::vector<IsovalueSuggestion>& suggestions) {
  std::optional<double> chosen;
  leaveRoomForLabel();
  if (!ImGui::BeginCombo("Presets", "choose")) return chosen;
  for (const IsovalueSuggestion& one : suggestions) {
    if (ImGui::Selectable(fmt::format("{:.5g}: {}", one.isovalue, one.reason).c_str())) chosen = one.isovalue;
  }
  ImGui::EndCombo();
  return chosen;
}

}  // namespace

void showSurfaceSection(WindowModel& model) {
  if (!section("Surface")) return;
  RigSettings servo = model.session.settings();
  const VolumeStatistics& statistics = model.session.volume().statistics;
  std::optional<double> wanted = histogram(statistics.histogram, servo.parameters.isovalue);
  tip("How often each density occurs. Drag the line to move the surface.");
  double isovalue = servo.parameters.isovalue;
  leaveRoomForLabel();
  if (ImGui::InputDouble("Isovalue", &isovalue, 0, 0, "%.5g", ImGuiInputTextFlags_EnterReturnsTrue)) wanted = isovalue;
  if (const auto chosen = preset(statistics.suggestions)) wanted = chosen;
  if (!wanted || static_cast<float>(*wanted) == servo.parameters.isovalue) return;
  servo.parameters.isovalue = *wanted;
  orSay(model, [&] { model.session.change(servo); });
}

}  // namespace palpate
