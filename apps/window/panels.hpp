// SPDX-License-Identifier: Apache-2.0
// apps/window/panels.hpp: the panels beside and below the picture. They show the model and change it; a refusal is said
// as a message. One thread; between GuiHost::begin() and end().
#pragma once

#include "apps/window/window_model.hpp"

namespace palpate {

// Where the picture is [ImGui's coordinates].
struct PictureArea {
  float x = 0, y = 0, width = 0, height = 0;
};

// All panels of the window, at this scale. Returns the place that they leave for the picture.
[[nodiscard]] PictureArea showPanels(WindowModel& model, double scale);

// What is drawn over the picture: tool, surface point, force, plane, path, brush.
void showOverlay(const WindowModel& model, const PictureArea& area, double scale);

// Begins to write the file that is named at the top left. Returns false where that is refused, and says why, and where
// a file of others lies there: then it asks.
bool saveAs(WindowModel& model);
// Begins a recording of the tool's way in the current folder, or ends it.
void toggleRecording(WindowModel& model);

// The sections, each in a file of its own.
void showFileSection(WindowModel& model);
void showBrushSection(WindowModel& model);
void showSurfaceSection(WindowModel& model);
void showViewSection(WindowModel& model);
void showCutsSection(WindowModel& model);
void showEditsSection(WindowModel& model);
void showTouchSection(WindowModel& model);
void showMeasuredSection(WindowModel& model);
void showFaultsSection(WindowModel& model);
void showPlanSection(const WindowModel& model);
void showStatus(WindowModel& model);
void showLeaveQuestion(WindowModel& model);
void showOverwriteQuestion(WindowModel& model);

}  // namespace palpate
