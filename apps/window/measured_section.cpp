// SPDX-License-Identifier: Apache-2.0
#include <cfloat>

#include <fmt/format.h>
#include <imgui.h>

#include "apps/window/panel_parts.hpp"
#include "apps/window/panels.hpp"

namespace palpate {
namespace {

struct Plot {
  const char* name;
  const Trace* trace;
  const char* form;
  float low;  // of the axis; FLT_MAX: that of the values
  const char* help;
};

void show(const Plot& plot) {
  const std::string newest = fmt::format(fmt::runtime(plot.form), plot.trace->newest);
  const ImVec2 size(ImGui::GetContentRegionAvail().x - ImGui::GetFontSize() * 6.5F, ImGui::GetFontSize() * 2);
  ImGui::PushID(plot.name);
  ImGui::PlotLines("##plot", plot.trace->values.data(), static_cast<int>(Trace::kLength),
                   static_cast<int>(plot.trace->next), newest.c_str(), plot.low, FLT_MAX, size);
  ImGui::PopID();
  ImGui::SameLine();
  ImGui::TextUnformatted(plot.name);
  tip(plot.help);
}

}  // namespace

void showMeasuredSection(WindowModel& model) {
  if (!section("Measured")) return;
  const Plot plots[] = {
      {"Force", &model.force_N, "{:.2f} N", 0, "that the device holds"},
      {"Depth", &model.depth_mm, "{:.2f} mm", 0, "of the tool below the surface"},
      {"Energy", &model.energy_mJ, "{:.2f} mJ", FLT_MAX,
       "that the hand has given to the surface so far; where it falls below 0, the surface gives more than it got"},
      {"Tick", &model.cost_us, "{:.1f} us", 0, "time that the servo computes in a tick"},
      {"Lateness", &model.lateness_us, "{:.0f} us", 0, "of the servo's ticks"},
      {"Window age", &model.window_age_ms, "{:.1f} ms", 0,
       "since the samples around the tool were known to be those of the volume"},
  };
  for (const Plot& plot : plots) show(plot);
}

}  // namespace palpate
