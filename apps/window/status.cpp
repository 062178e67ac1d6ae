// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <imgui.h>

#include "apps/window/panel_parts.hpp"
#include "apps/window/panels.hpp"

namespace palpate {

void showStatus(WindowModel& model) {
  const ForceWords words = forceWordsOf(model);
  ImGui::TextUnformatted(words.state.c_str());
  ImGui::SameLine(ImGui::GetFontSize() * 12);
  std::string reasons;
  for (const std::string& reason : words.reasons) reasons += (reasons.empty() ? "" : "   ") + reason;
  ImGui::TextDisabled("%s", reasons.c_str());
  for (const std::string* trouble : {&model.state.drawing_failure, &model.state.journal_failure}) {
    if (!trouble->empty()) ImGui::TextColored(ImVec4(0.9F, 0.4F, 0.1F, 1), "%s", trouble->c_str());
  }
  if (!model.messages.empty()) {
    ImGui::TextWrapped("%s", model.messages.back().c_str());
    return;
  }
  ImGui::TextDisabled(
      "left button: stroke    right button: turn    Shift + right: move    wheel: zoom    F: size    "
      "Ctrl+Z: undo");
  ImGui::TextDisabled(
      "without a mouse: arrows, Space, Page up and down; Ctrl + arrows turn; Tab: to the panels, Esc: "
      "back");
}

void showLeaveQuestion(WindowModel& model) {
  Leaving& leaving = model.leaving;
  if (leaving.asks) ImGui::OpenPopup("Unsaved work");
  const ImVec2 middle = ImGui::GetMainViewport()->GetCenter();
  ImGui::SetNextWindowPos(middle, ImGuiCond_Appearing, ImVec2(0.5F, 0.5F));
  if (!ImGui::BeginPopupModal("Unsaved work", nullptr, ImGuiWindowFlags_AlwaysAutoResize)) return;
  const bool is_lost = !model.state.journal_failure.empty() || !model.session.keepsJournal();
  ImGui::TextUnformatted(
      is_lost ? "There are edits that neither a file nor the journal holds.\nWithout a file they are lost."
              : "There are edits that no file holds.\nThe journal keeps them until the next start.");
  const bool named = model.file[0] != '\0';
  ImGui::BeginDisabled(!named);
  const bool saves = ImGui::Button(named ? fmt::format("Save {}", model.file).c_str() : "Save (name a file first)");
  ImGui::EndDisabled();
  ImGui::SameLine();
  const std::string without =
      fmt::format("{}, {}", leaving.volume.empty() ? "Close" : "Open", is_lost ? "lose them" : "keep the journal");
  const bool leaves = ImGui::Button(without.c_str());
  ImGui::SameLine();
  const bool stays = ImGui::Button("Go on") || ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape));
  const bool saved = saves && saveAs(model);  // or it is said why not
  if (saves || leaves || stays) {
    leaving.asks = false;
    leaving.goes = leaves || saved;
    leaving.keeps = leaves;
    model.overwriting.leaves_after = saves && !model.overwriting.file.empty();
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

}  // namespace palpate
