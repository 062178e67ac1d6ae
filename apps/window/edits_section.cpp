// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <imgui.h>

#include "apps/window/panel_parts.hpp"
#include "apps/window/panels.hpp"

namespace palpate {

void showEditsSection(WindowModel& model) {
  if (!section("Edits")) return;
  const RigEdits::State& edits = model.state.edits;
  ImGui::BeginDisabled(!edits.canUndo());
  if (ImGui::Button("Undo", inRow(2))) model.session.undo();
  ImGui::EndDisabled();
  tip("Ctrl+Z");
  ImGui::SameLine();
  ImGui::BeginDisabled(!edits.canRedo());
  if (ImGui::Button("Redo", inRow(2))) model.session.redo();
  ImGui::EndDisabled();
  tip("Ctrl+Shift+Z");
  const float height = ImGui::GetTextLineHeightWithSpacing() * 5;
  if (!ImGui::BeginChild("list", ImVec2(0, height), true)) return ImGui::EndChild();
  const auto row = [&](std::size_t done, const std::string& words) {
    if (done > edits.done) ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
    if (ImGui::Selectable(words.c_str(), done == edits.done)) model.session.goTo(done);
    if (done > edits.done) ImGui::PopStyleColor();
  };
  const std::size_t older = model.state.older_steps;
  // A long list costs what is seen of it.
  ImGuiListClipper clipper;
  clipper.Begin(static_cast<int>(edits.steps.size()) + 1);
  while (clipper.Step()) {
    for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) {
      const auto at = static_cast<std::size_t>(i);
      if (at == 0) {
        row(0, older == 0 ? "as it was opened" : fmt::format("as it was opened, and {} more steps", older));
        continue;
      }
      const UndoLabel& step = edits.steps[at - 1];
      row(older + at, fmt::format("{}  {}: {} {}", older + at, editName(step.kind), step.edits,
                                  step.edits == 1 ? "edit" : "edits"));
    }
  }
  ImGui::EndChild();
}

}  // namespace palpate
