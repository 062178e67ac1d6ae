// SPDX-License-Identifier: Apache-2.0
#include "apps/window/panels.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <imgui.h>

#include "apps/sculpt/force_words.hpp"
#include "base/error.hpp"
#include "base/units.hpp"
#include "servo/algorithms/registry.hpp"

namespace palpate {
namespace {

constexpr float kLeft = 300, kRight = 290, kBottom = 86;  // [pixel] at 1x
constexpr ImGuiWindowFlags kPanel = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                                    ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoBringToFrontOnFocus;

void tip(const char* text) {
  if (!ImGui::IsItemHovered()) return;
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(ImGui::GetFontSize() * 22);
  ImGui::TextUnformatted(text);
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

void head(const char* title) {
  ImGui::Spacing();
  ImGui::TextDisabled("%s", title);
  ImGui::Separator();
}

// A slider of a quantity in SI units, shown in units of `unit`. Returns whether it was moved.
bool slider(const char* label, double& value, double low, double high, double unit, const char* form,
            bool logarithmic) {
  auto shown = static_cast<float>(value / unit);
  ImGui::SetNextItemWidth(-ImGui::GetFontSize() * 6.5F);
  const bool moved =
      ImGui::SliderFloat(label, &shown, static_cast<float>(low / unit), static_cast<float>(high / unit), form,
                         (logarithmic ? ImGuiSliderFlags_Logarithmic : 0) | ImGuiSliderFlags_AlwaysClamp);
  if (moved) value = shown * unit;
  return moved;
}

// The size of one of three buttons in a row.
ImVec2 third() {
  const float all = ImGui::GetWindowContentRegionMax().x - ImGui::GetWindowContentRegionMin().x;
  return {(all - 2 * ImGui::GetStyle().ItemSpacing.x) / 3, 0};
}

template <typename Work>
void orSay(WindowModel& model, const Work& work) {
  try {
    work();
  } catch (const Error& error) {
    model.say(error.what());
  }
}

void changeServo(WindowModel& model, const RigSettings& settings) {
  orSay(model, [&] { model.session.change(settings); });
}

void filePanel(WindowModel& model) {
  const SculptVolume& volume = model.session.volume();
  ImGui::TextWrapped("%s%s", volume.name.c_str(), model.state.unsaved ? " *" : "");
  const Vec3 size_mm = volume.size.cast<double>().cwiseProduct(volume.lattice.spacing_m) * kMillimetresPerMetre;
  ImGui::TextDisabled("%d x %d x %d voxels, %.0f x %.0f x %.0f mm", volume.size.x(), volume.size.y(), volume.size.z(),
                      size_mm.x(), size_mm.y(), size_mm.z());
  ImGui::SetNextItemWidth(-ImGui::GetFontSize() * 4);
  const bool entered = ImGui::InputTextWithHint("##file", "sculpted.vdb", model.file, sizeof model.file,
                                                ImGuiInputTextFlags_EnterReturnsTrue);
  tip("File to write: .vdb, .nii, .nii.gz, .nrrd or .mha for the volume, .stl, .ply or .obj for its surface");
  ImGui::SameLine();
  if (ImGui::Button("Save", ImVec2(-1, 0)) || entered) {
    if (model.file[0] == '\0') {
      model.say("name a file first, for example sculpted.vdb");
    } else {
      orSay(model, [&] { model.session.save(model.file); });
    }
  }
  tip("Writes the volume with every edit (Ctrl+S). Sculpting goes on meanwhile.");
  if (model.state.errands > 0) ImGui::TextDisabled("writing ...");
}

void brushPanel(WindowModel& model) {
  head("BRUSH");
  BrushChoice& brush = model.settings.brush;
  int column = 0;
  for (const BrushEntry& entry : brushes()) {
    if (column++ % 3 != 0) ImGui::SameLine(static_cast<float>((column - 1) % 3) * ImGui::GetWindowWidth() * 0.31F + 10);
    if (ImGui::RadioButton(entry.name, brush.kind == entry.kind)) brush.kind = entry.kind;
    const std::string words =
        fmt::format("{}{}{}", entry.help, *entry.inverse != '\0' ? "; Ctrl: " : "", entry.inverse);
    tip(words.c_str());
  }
  slider("Radius", brush.radius_m, 1e-4, 0.03, kMetresPerMillimetre, "%.2f mm", true);
  tip("F, then move the mouse");
  slider("Strength", brush.strength, 0.01, 1, 1, "%.2f", false);
  tip("How fast it works: Shift+F, then move the mouse");
  slider("Depth", model.settings.reach.depth_m, 1e-4, 0.01, kMetresPerMillimetre, "%.2f mm", true);
  tip("How far the mouse presses the tool below the surface; the wheel changes it during a stroke");
  int mirror = brush.mirror_axis ? *brush.mirror_axis + 1 : 0;
  ImGui::SetNextItemWidth(-ImGui::GetFontSize() * 6.5F);
  if (ImGui::Combo("Mirror", &mirror, "none\0X\0Y\0Z\0"))
    brush.mirror_axis = mirror == 0 ? std::nullopt : std::optional(mirror - 1);
  tip("Repeats strokes on the other side of the volume's middle (keys X, Y, Z)");
}

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

void surfacePanel(WindowModel& model) {
  head("SURFACE");
  RigSettings servo = model.session.settings();
  const VolumeStatistics& statistics = model.session.volume().statistics;
  std::optional<double> wanted = histogram(statistics.histogram, servo.parameters.isovalue);
  tip("How often each density occurs. Drag the line to move the surface.");
  double isovalue = servo.parameters.isovalue;
  ImGui::SetNextItemWidth(-ImGui::GetFontSize() * 6.5F);
  if (ImGui::InputDouble("Isovalue", &isovalue, 0, 0, "%.5g", ImGuiInputTextFlags_EnterReturnsTrue)) wanted = isovalue;
  for (std::size_t i = 0; i < std::min<std::size_t>(statistics.suggestions.size(), 4); ++i) {
    const IsovalueSuggestion& suggestion = statistics.suggestions[i];
    if (i > 0) ImGui::SameLine();
    if (ImGui::SmallButton(fmt::format("{:.4g}##{}", suggestion.isovalue, i).c_str())) wanted = suggestion.isovalue;
    tip(suggestion.reason.c_str());
  }
  if (!wanted || static_cast<float>(*wanted) == servo.parameters.isovalue) return;
  servo.parameters.isovalue = *wanted;
  changeServo(model, servo);
}

void viewPanel(WindowModel& model) {
  head("VIEW");
  constexpr std::pair<const char*, ViewAngles> kSides[] = {{"Front", {0, 0}},         {"Back", {M_PI, 0}},
                                                           {"Left", {M_PI / 2, 0}},   {"Right", {-M_PI / 2, 0}},
                                                           {"Top", {M_PI, M_PI / 2}}, {"Bottom", {0, -M_PI / 2}}};
  for (int i = 0; i < 6; ++i) {
    if (i % 3 != 0) ImGui::SameLine();
    if (ImGui::Button(kSides[i].first, third())) model.view.turnTo(kSides[i].second);
  }
  if (ImGui::Button("All of it", third())) model.view.fit();
  tip("Home");
  ImGui::SameLine();
  bool shaded = model.style.occlusion;
  if (ImGui::Checkbox("Shade hollows", &shaded)) model.style.occlusion = shaded;
}

void historyPanel(WindowModel& model) {
  head("EDITS");
  const RigEdits::State& edits = model.state.edits;
  ImGui::BeginDisabled(!edits.can_undo);
  if (ImGui::Button("Undo", third())) model.session.undo();
  ImGui::EndDisabled();
  tip("Ctrl+Z");
  ImGui::SameLine();
  ImGui::BeginDisabled(!edits.can_redo);
  if (ImGui::Button("Redo", third())) model.session.redo();
  ImGui::EndDisabled();
  tip("Ctrl+Shift+Z");
  ImGui::TextDisabled("%zu %s, %zu undone", edits.undo_steps, edits.undo_steps == 1 ? "stroke" : "strokes",
                      edits.redo_steps);
}

void servoPanel(WindowModel& model) {
  head("TOUCH");
  RigSettings servo = model.session.settings();
  const RigSettings before = servo;
  AlgorithmParameters& p = servo.parameters;
  if (ImGui::BeginCombo("##algorithm", servo.algorithm.c_str())) {
    for (const AlgorithmEntry& entry : algorithms()) {
      if (ImGui::Selectable(std::string(entry.name).c_str(), entry.name == servo.algorithm))
        servo.algorithm = entry.name;
      tip(std::string(entry.description).c_str());
    }
    ImGui::EndCombo();
  }
  slider("Stiffness", p.stiffness_N_per_m, 20, 3000, 1, "%.0f N/m", true);
  slider("Damping", p.damping_Ns_per_m, 0, 5, 1, "%.2f N s/m", false);
  ImGui::SetNextItemWidth(-ImGui::GetFontSize() * 6.5F);
  ImGui::SliderInt("Renewal", &p.plane_renewal_ticks, 1, 100, "%d ticks", ImGuiSliderFlags_Logarithmic);
  tip("The plane under the tool is found anew after so many ticks");
  slider("Friction", servo.effects.friction.dynamic_ratio, 0, 1, 1, "%.2f", false);
  servo.effects.friction.static_ratio = 1.2 * servo.effects.friction.dynamic_ratio;
  slider("Recovery", servo.effects.recovery_s, 0, 0.1, 1e-3, "%.0f ms", false);
  tip("The force goes over from plane to plane in this time; 0: at once");
  slider("Force limit", servo.force_limit_N, 0.5, 8, 1, "%.1f N", false);
  if (!(servo == before)) changeServo(model, servo);
}

void plot(const char* name, const Trace& trace, const char* form) {
  const std::string newest = fmt::format(fmt::runtime(form), trace.newest);
  const ImVec2 size(ImGui::GetContentRegionAvail().x - ImGui::GetFontSize() * 6.5F, ImGui::GetFontSize() * 2.6F);
  ImGui::PlotLines("##plot", trace.values.data(), static_cast<int>(Trace::kLength), static_cast<int>(trace.next),
                   newest.c_str(), 0, FLT_MAX, size);
  ImGui::SameLine();
  ImGui::TextUnformatted(name);
}

void plotsPanel(WindowModel& model) {
  head("MEASURED");
  const std::pair<const char*, std::pair<const Trace*, const char*>> kPlots[] = {
      {"Force", {&model.force_N, "{:.2f} N"}},
      {"Depth", {&model.depth_mm, "{:.2f} mm"}},
      {"Tick", {&model.cost_us, "{:.1f} us"}},
      {"Lateness", {&model.lateness_us, "{:.0f} us"}},
      {"Window age", {&model.window_age_ms, "{:.1f} ms"}}};
  for (const auto& [name, of] : kPlots) {
    ImGui::PushID(name);
    plot(name, *of.first, of.second);
    ImGui::PopID();
  }
}

void statusPanel(WindowModel& model) {
  const ForceWords words = forceWords(model.tick, model.state.running, model.session.settings().parameters.isovalue);
  ImGui::TextUnformatted(words.state.c_str());
  ImGui::SameLine(ImGui::GetFontSize() * 12);
  std::string reasons;
  for (const std::string& reason : words.reasons) reasons += (reasons.empty() ? "" : "   ") + reason;
  ImGui::TextDisabled("%s", reasons.c_str());
  for (const std::string* trouble : {&model.state.drawing_failure, &model.state.journal_failure}) {
    if (!trouble->empty()) ImGui::TextColored(ImVec4(0.9F, 0.4F, 0.1F, 1), "%s", trouble->c_str());
  }
  if (!model.messages.empty()) ImGui::TextWrapped("%s", model.messages.back().c_str());
  if (model.messages.empty()) {
    ImGui::TextDisabled(
        "left button: stroke    right button: turn    Shift + right: move    wheel: zoom    F: size    Ctrl+Z: undo");
  }
}

void closePanel(WindowModel& model) {
  if (model.asks_to_close) ImGui::OpenPopup("Unsaved work");
  const ImVec2 middle = ImGui::GetMainViewport()->GetCenter();
  ImGui::SetNextWindowPos(middle, ImGuiCond_Appearing, ImVec2(0.5F, 0.5F));
  if (!ImGui::BeginPopupModal("Unsaved work", nullptr, ImGuiWindowFlags_AlwaysAutoResize)) return;
  ImGui::TextUnformatted("There are edits that no file holds.\nThe journal keeps them until the next start.");
  const bool named = model.file[0] != '\0';
  ImGui::BeginDisabled(!named);
  const bool saves = ImGui::Button(named ? fmt::format("Save {}", model.file).c_str() : "Save (name a file first)");
  ImGui::EndDisabled();
  ImGui::SameLine();
  const bool leaves = ImGui::Button("Close, keep the journal");
  ImGui::SameLine();
  const bool stays = ImGui::Button("Go on") || ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape));
  if (saves) orSay(model, [&] { model.session.save(model.file); });
  model.closes = saves || leaves;
  if (saves || leaves || stays) {
    model.asks_to_close = false;
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

template <typename Content>
void panel(const char* name, const ImVec2& at, const ImVec2& size, const Content& content) {
  ImGui::SetNextWindowPos(at);
  ImGui::SetNextWindowSize(size);
  if (ImGui::Begin(name, nullptr, kPanel)) content();
  ImGui::End();
}

}  // namespace

PictureArea showPanels(WindowModel& model, double scale) {
  const ImVec2 all = ImGui::GetIO().DisplaySize;
  const auto by = static_cast<float>(scale);
  const float left = std::min(kLeft * by, all.x / 3), right = std::min(kRight * by, all.x / 3);
  const float bottom = std::min(kBottom * by, all.y / 3);
  panel("left", ImVec2(0, 0), ImVec2(left, all.y - bottom), [&] {
    filePanel(model);
    brushPanel(model);
    surfacePanel(model);
    viewPanel(model);
    historyPanel(model);
  });
  panel("right", ImVec2(all.x - right, 0), ImVec2(right, all.y - bottom), [&] {
    servoPanel(model);
    plotsPanel(model);
  });
  panel("status", ImVec2(0, all.y - bottom), ImVec2(all.x, bottom), [&] { statusPanel(model); });
  closePanel(model);
  return {left, 0, std::max(1.0F, all.x - left - right), std::max(1.0F, all.y - bottom)};
}

}  // namespace palpate
