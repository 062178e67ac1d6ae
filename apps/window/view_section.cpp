// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <imgui.h>

#include "apps/window/panel_parts.hpp"
#include "apps/window/panels.hpp"

namespace palpate {
namespace {

void secondSurface(WindowModel& model) {
  bool on = model.sight.second_isovalue.has_value();
  const VolumeStatistics& statistics = model.session.volume().statistics;
  const double first = model.session.settings().parameters.isovalue;
  if (ImGui::Checkbox("Second surface", &on)) {
    model.sight.second_isovalue = on ? std::optional((statistics.minimum + first) / 2) : std::nullopt;
  }
  tip("A translucent surface before the first: skin over bone");
  if (!model.sight.second_isovalue) return;
  slider("at density", *model.sight.second_isovalue, statistics.minimum, statistics.maximum, 1, "%.4g");
  shareSlider("opacity", model.sight.second_opacity);
}

}  // namespace

void showViewSection(WindowModel& model) {
  if (!section("View")) return;
  struct Side {
    const char* name;
    ViewKey key;
    const char* keys;
  };
  constexpr Side kSides[] = {{"Front", ViewKey::kFront, "1"},    {"Back", ViewKey::kBack, "Ctrl+1"},
                             {"Left", ViewKey::kLeft, "Ctrl+3"}, {"Right", ViewKey::kRight, "3"},
                             {"Top", ViewKey::kTop, "7"},        {"Bottom", ViewKey::kBottom, "Ctrl+7"}};
  for (int i = 0; i < 6; ++i) {
    if (i % 3 != 0) ImGui::SameLine();
    if (ImGui::Button(kSides[i].name, inRow(3))) model.view.turnTo(anglesOf(kSides[i].key));
    tip(kSides[i].keys);
  }
  if (ImGui::Button("All of it", inRow(3))) model.view.fit();
  tip("Home");
  ImGui::SameLine();
  ImGui::Checkbox("Shade hollows", &model.sight.occlusion);
  secondSurface(model);
  bool light = !model.settings.dark;
  if (ImGui::Checkbox("Light", &light)) model.settings.dark = !light;
  ImGui::SameLine();
  ImGui::SetNextItemWidth(-ImGui::GetFontSize() * 3);
  constexpr double kScales[] = {0, 1, 1.25, 1.5, 2, 3};
  if (ImGui::BeginCombo(
          "size", model.settings.scale == 0 ? "of the display" : fmt::format("{:g}x", model.settings.scale).c_str())) {
    for (const double scale : kScales) {
      const std::string name = scale == 0 ? "of the display" : fmt::format("{:g}x", scale);
      if (ImGui::Selectable(name.c_str(), scale == model.settings.scale)) model.settings.scale = scale;
    }
    ImGui::EndCombo();
  }
}

void showCutsSection(WindowModel& model) {
  if (!section("Cuts and slices", false)) return;
  for (std::size_t i = 0; i < 3; ++i) {
    ImGui::PushID(static_cast<int>(i));
    CutChoice& cut = model.sight.cuts[i];
    SliceChoice& slice = model.sight.slices[i];
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(fmt::format("{} ({})", "XYZ"[i], kWorldAxes[i]).c_str());
    ImGui::SameLine(ImGui::GetFontSize() * 5);
    ImGui::Checkbox("cut", &cut.on);
    tip("Draws only what lies on one side of a plane. What is cut away is felt as before.");
    ImGui::SameLine();
    ImGui::Checkbox("slice", &slice.on);
    tip("Shows the density on a plane through the volume");
    if (cut.on) {
      ImGui::SameLine();
      ImGui::Checkbox("flip", &cut.keeps_low);
      tip("Draws the other side");
      shareSlider("cut at", cut.share);
    }
    if (slice.on) shareSlider("slice at", slice.share);
    ImGui::PopID();
  }
  const VolumeStatistics& statistics = model.session.volume().statistics;
  for (const auto& [label, value] :
       {std::pair{"black", &model.sight.slice_range.black}, std::pair{"white", &model.sight.slice_range.white}}) {
    slider(label, *value, statistics.minimum, statistics.maximum, 1, "%.4g");
    tip("Density that slices show so");
  }
}

}  // namespace palpate
