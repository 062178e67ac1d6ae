// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <utility>

#include <fmt/format.h>
#include <imgui.h>

#include "apps/mesh/mesh_writer.hpp"
#include "apps/sculpt/dated_name.hpp"
#include "apps/window/panel_parts.hpp"
#include "apps/window/panels.hpp"
#include "base/units.hpp"
#include "engine/files/volume_file.hpp"

namespace palpate {
namespace {

// Opens with Enter, or from the list of those that were open before.
void openRow(WindowModel& model) {
  ImGui::SetNextItemWidth(-ImGui::GetFontSize() * 4);
  const bool entered = ImGui::InputTextWithHint("##open", "another volume", model.opens, sizeof model.opens,
                                                ImGuiInputTextFlags_EnterReturnsTrue);
  tip("A file, a DICOM folder or phantom:NAME to open. A file can be dropped on the window too.");
  ImGui::SameLine();
  if ((ImGui::Button("Open", ImVec2(-1, 0)) || entered) && model.opens[0] != '\0') model.open(model.opens);
  if (model.settings.recent.size() < 2) return;
  ImGui::SetNextItemWidth(-1);
  if (!ImGui::BeginCombo("##recent", "opened before")) return;
  for (const std::string& volume : model.settings.recent) {
    if (ImGui::Selectable(volume.c_str())) model.open(volume);
  }
  ImGui::EndCombo();
}

bool save(WindowModel& model, const std::string& file) {
  if (!orSay(model, [&] { model.session.save(file); })) return false;
  model.saved.wrote(file);
  return true;
}

void saveRow(WindowModel& model) {
  ImGui::SetNextItemWidth(-ImGui::GetFontSize() * 4);
  const bool entered = ImGui::InputTextWithHint("##file", "sculpted.vdb", model.file, sizeof model.file,
                                                ImGuiInputTextFlags_EnterReturnsTrue);
  tip(fmt::format("File to write: {} for the volume, {} for its surface", volumeFileSuffixes(), kMeshFileSuffixes));
  ImGui::SameLine();
  if (ImGui::Button("Save", ImVec2(-1, 0)) || entered) saveAs(model);
  tip("Writes the volume with every edit (Ctrl+S). Sculpting goes on meanwhile.");
}

}  // namespace

bool saveAs(WindowModel& model) {
  if (model.file[0] == '\0') {
    model.say("name a file first, at the top left: for example sculpted.vdb");
    return false;
  }
  if (model.saved.isForeign(model.file)) {
    model.overwriting = {.file = model.file};
    return false;
  }
  return save(model, model.file);
}

void showOverwriteQuestion(WindowModel& model) {
  if (!model.overwriting.file.empty()) ImGui::OpenPopup("Overwrite");
  ImGui::SetNextWindowPos(ImGui::GetMainViewport()->GetCenter(), ImGuiCond_Appearing, ImVec2(0.5F, 0.5F));
  if (!ImGui::BeginPopupModal("Overwrite", nullptr, ImGuiWindowFlags_AlwaysAutoResize)) return;
  ImGui::Text("%s is there already,\nand this session has not written it.", model.overwriting.file.c_str());
  const bool saves = ImGui::Button("Overwrite it");
  ImGui::SameLine();
  const bool stays = ImGui::Button("Leave it") || ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape));
  if (saves || stays) {
    const Overwriting asked = std::exchange(model.overwriting, {});
    if (saves && save(model, asked.file) && asked.leaves_after) model.leaving.goes = true;
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

void toggleRecording(WindowModel& model) {
  orSay(model, [&] {
    if (!model.recording) {
      model.recording.emplace(datedName(".", "palpate-way", ".csv"), model.session.settings().parameters.rate_hz);
      return;
    }
    model.recording->close();
    const std::string file = model.recording->file().string();
    model.say(fmt::format("{} holds {:.1f} s of the tool's way and its brushes. It is replayed by: {}", file,
                          model.recording->seconds(),
                          replayCommand(model.session.volume().name, file, model.session.settings())));
    model.recording.reset();
  });
}

void showFileSection(WindowModel& model) {
  const SeenVolume& volume = model.session.volume();
  const std::string name = std::filesystem::path(volume.name).filename().string();
  ImGui::TextWrapped("%s%s", (name.empty() ? volume.name : name).c_str(), model.state.unsaved ? " *" : "");
  tip(volume.name + (model.state.unsaved ? "\n*: no file holds the last edits; the journal does" : ""));
  const Vec3 size_mm = volume.size.cast<double>().cwiseProduct(volume.lattice.spacing_m) * kMillimetresPerMetre;
  mutedText(fmt::format("{} x {} x {} voxels, {:.0f} x {:.0f} x {:.0f} mm", volume.size.x(), volume.size.y(),
                        volume.size.z(), size_mm.x(), size_mm.y(), size_mm.z()));
  saveRow(model);
  if (model.session.canBeReplaced()) openRow(model);
  if (ImGui::Button("Picture", inRow(2))) model.wants_screenshot = true;
  tip("Writes a picture of the window into the current folder (F12)");
  ImGui::SameLine();
  if (ImGui::Button(model.recording ? "End recording" : "Record", inRow(2))) toggleRecording(model);
  tip("Writes the tool's way and its brushes into a file that 'palpate touch --path' replays (F9)");
  if (model.recording) mutedText(fmt::format("recording: {:.1f} s", model.recording->seconds()));
  if (model.state.errands > 0) mutedText("writing ...");
}

}  // namespace palpate
