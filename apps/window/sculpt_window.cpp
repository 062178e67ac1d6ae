// SPDX-License-Identifier: Apache-2.0
#include "apps/window/sculpt_window.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <imgui.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "apps/console/interrupt.hpp"
#include "apps/render/slice_range.hpp"
#include "apps/sculpt/dated_name.hpp"
#include "apps/view/picture_png.hpp"
#include "apps/window/panel_parts.hpp"
#include "base/atomic_file.hpp"
#include "base/error.hpp"
#include "base/units.hpp"

namespace palpate {
namespace {

constexpr double kFrame_s = 1.0 / 60;
constexpr double kIdle_s = 0.1;           // between two frames in which nothing happens: plots and figures go on
constexpr int kTicksPerPoint = 10;        // of a plot
constexpr std::size_t kPathPoints = 400;  // of the path that is drawn, each kTicksPerPoint ticks after the last

bool pressed(int key) {
  return ImGui::IsKeyPressed(key, false) && !ImGui::GetIO().WantTextInput;
}

std::optional<ViewKey> viewKey(bool opposite) {
  if (pressed(GLFW_KEY_1) || pressed(GLFW_KEY_KP_1)) return opposite ? ViewKey::kBack : ViewKey::kFront;
  if (pressed(GLFW_KEY_3) || pressed(GLFW_KEY_KP_3)) return opposite ? ViewKey::kLeft : ViewKey::kRight;
  if (pressed(GLFW_KEY_7) || pressed(GLFW_KEY_KP_7)) return opposite ? ViewKey::kBottom : ViewKey::kTop;
  if (pressed(GLFW_KEY_HOME)) return ViewKey::kFit;
  return std::nullopt;
}

// `by`: pixels of the picture per unit of ImGui.
PointerInput pointerInput(const PictureArea& area, const ImVec2& by) {
  const ImGuiIO& io = ImGui::GetIO();
  PointerInput input;
  input.x = (io.MousePos.x - area.x) * by.x;
  input.y = (io.MousePos.y - area.y) * by.y;
  input.dx = io.MouseDelta.x * by.x;
  input.dy = io.MouseDelta.y * by.y;
  input.over = !io.WantCaptureMouse && io.MousePos.x >= area.x && io.MousePos.x < area.x + area.width &&
               io.MousePos.y >= area.y && io.MousePos.y < area.y + area.height;
  input.wheel = io.MouseWheel;
  input.left = io.MouseDown[ImGuiMouseButton_Left];
  input.middle = io.MouseDown[ImGuiMouseButton_Middle];
  input.right = io.MouseDown[ImGuiMouseButton_Right];
  input.shift = io.KeyShift;
  input.ctrl = io.KeyCtrl;
  input.alt = io.KeyAlt;
  input.size_key = pressed(GLFW_KEY_F);
  input.cancel_key = pressed(GLFW_KEY_ESCAPE);
  input.view_key = viewKey(io.KeyCtrl);
  return input;
}

}  // namespace

SculptWindow::SculptWindow(GuiHost& host, SculptSide& session, SculptSettings settings)
    : host_(host),
      model_{.session = session, .settings = std::move(settings), .view = OrbitView(session.volume().object, 640, 480)},
      lead_(model_.view.distance_m()) {
  model_.sight.slice_range = sliceRangeFor(session.volume().statistics);
  look();  // what is said later is the newest
}

std::string SculptWindow::run() {
  model_.leaving = {};
  ImGui::SetWindowFocus(nullptr);  // a question had the keyboard
  while (!done()) {
    const bool busy = model_.gestures.kind() != Gestures::Kind::kNone || frames_after_event_ > 0;
    if (host_.listen(busy ? kFrame_s / 2 : kIdle_s)) frames_after_event_ = 3;
    frames_after_event_ = std::max(0, frames_after_event_ - 1);
    frame();
  }
  model_.session.release();
  if (model_.recording) toggleRecording(model_);
  return std::exchange(model_.leaving, {}).volume;
}

bool SculptWindow::done() {
  if (interrupted()) {
    model_.leaving = {};
    return true;
  }
  if (model_.leaving.goes) {
    if (model_.state.errands > 0 && model_.state.can_edit) return false;
    const bool lost = model_.state.unsaved && model_.state.can_edit && !model_.leaving.keeps;
    if (!lost) return true;
    model_.leaving.goes = false;  // a file was not written, or something was edited meanwhile
    model_.leaving.asks = true;
  }
  const std::vector<std::string> dropped = host_.takeDroppedFiles();
  if (!dropped.empty()) model_.open(dropped.front());
  if (dropped.size() > 1)
    model_.say(fmt::format("{} is opened; the other {} dropped files are not", dropped.front(), dropped.size() - 1));
  if (!host_.wantsToClose()) return false;
  host_.refuseToClose();
  look();
  model_.close();
  return false;
}

void SculptWindow::frame() {
  changeHost();
  look();
  host_.begin();
  keys();
  const double scale = host_.scale();
  const PictureArea area = showPanels(model_, scale);
  pointer(area);
  showOverlay(model_, area, scale);
  const ViewFrame& picture = model_.session.frame();
  const ImVec2 by = ImGui::GetIO().DisplayFramebufferScale;
  const PlacedPicture placed{picture.number == 0 ? nullptr : &picture.pixels, picture.camera.width,
                             picture.camera.height, static_cast<int>(area.x * by.x), static_cast<int>(area.y * by.y)};
  if (std::exchange(model_.wants_screenshot, false)) {
    keepScreenshot(host_.endAndCapture(placed));
  } else {
    host_.end(placed);
  }
}

// What can be changed only between two frames; and what the person changed of the window itself.
void SculptWindow::changeHost() {
  host_.setDark(model_.settings.dark);
  host_.setScale(model_.settings.scale);
  const auto [width, height] = host_.size();
  if (width < SculptSettings::kLeastWidth || height < SculptSettings::kLeastHeight) return;  // minimised
  model_.settings.width = width;
  model_.settings.height = height;
}

void SculptWindow::keepScreenshot(const std::optional<RenderedImage>& image) {
  if (!image) {  // nothing is shown now: of the next frame
    model_.wants_screenshot = true;
    return;
  }
  orSay(model_, [&] {
    const std::filesystem::path file = datedName(".", "palpate", ".png");
    writeFileAtomically(file, pngOf(*image));
    model_.say(fmt::format("{} is a picture of the window", file.string()));
  });
}

void SculptWindow::look() {
  model_.state = model_.session.look();
  for (const std::string& message : model_.state.messages) model_.say(message);
  ticks_.clear();
  model_.session.takeTicks(ticks_);
  // A point of the plots for each so many ticks: the largest of them.
  for (const TickRecord& tick : ticks_) {
    model_.faults.add(tick);
    if (!tick.in_contact) model_.path_W.clear();
    peak_.force = std::max(peak_.force, asVec3(tick.force_W).norm());
    peak_.depth = std::max(peak_.depth, tick.in_contact ? tick.depth_m : 0);
    peak_.cost = std::max(peak_.cost, tick.tick_cost_ns * 1e-3);
    peak_.lateness = std::max(peak_.lateness, static_cast<double>(tick.lateness_ns) * 1e-3);
    peak_.age = std::max(peak_.age, static_cast<double>(tick.window_age_ns) * 1e-6);
    if (tick.tick % kTicksPerPoint != kTicksPerPoint - 1) continue;
    model_.force_N.add(static_cast<float>(peak_.force));
    model_.depth_mm.add(static_cast<float>(peak_.depth * kMillimetresPerMetre));
    model_.energy_mJ.add(static_cast<float>(tick.energy_J * 1e3));
    model_.cost_us.add(static_cast<float>(peak_.cost));
    model_.lateness_us.add(static_cast<float>(peak_.lateness));
    model_.window_age_ms.add(static_cast<float>(peak_.age));
    peak_ = {};
    if (!tick.in_contact) continue;
    model_.path_W.push_back(asVec3(tick.vhip_W));
    if (model_.path_W.size() > kPathPoints) model_.path_W.pop_front();
  }
  record();
  model_.tick = model_.session.tick();
}

void SculptWindow::record() {
  if (!model_.recording) return;
  model_.recording->hold(model_.session.heldBrush());
  const bool kept = orSay(model_, [&] {
    for (const TickRecord& tick : ticks_) model_.recording->add(tick);
  });
  if (!kept) model_.recording.reset();
}

void SculptWindow::keys() {
  const ImGuiIO& io = ImGui::GetIO();
  if (pressed(GLFW_KEY_F12)) model_.wants_screenshot = true;
  if (pressed(GLFW_KEY_F9)) toggleRecording(model_);
  const bool in_panel = ImGui::IsWindowFocused(ImGuiFocusedFlags_AnyWindow);
  if (pressed(GLFW_KEY_TAB) && !in_panel) ImGui::SetWindowFocus("left");
  const bool busy = ImGui::IsAnyItemActive() || ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopup);
  if (pressed(GLFW_KEY_ESCAPE) && in_panel && !busy) ImGui::SetWindowFocus(nullptr);
  if (io.KeyCtrl && pressed(GLFW_KEY_Z)) io.KeyShift ? model_.session.redo() : model_.session.undo();
  if (io.KeyCtrl && pressed(GLFW_KEY_S)) saveAs(model_);
  if (io.KeyCtrl) return;
  BrushChoice& brush = model_.settings.brush;
  constexpr double kSizeStep = 1.1;
  if (pressed(GLFW_KEY_LEFT_BRACKET)) brush.scaleRadius(1 / kSizeStep);
  if (pressed(GLFW_KEY_RIGHT_BRACKET)) brush.scaleRadius(kSizeStep);
  for (int axis = 0; axis < 3; ++axis) {
    if (!pressed(GLFW_KEY_X + axis)) continue;
    brush.mirror_axis = brush.mirror_axis == axis ? std::nullopt : std::optional(axis);
  }
}

// While a panel has the keyboard, its keys belong to it.
PointerKeys SculptWindow::pointerKeys() const {
  const ImGuiIO& io = ImGui::GetIO();
  if (io.WantTextInput || ImGui::IsWindowFocused(ImGuiFocusedFlags_AnyWindow)) return {};
  return {.left = io.KeysDown[GLFW_KEY_LEFT],
          .right = io.KeysDown[GLFW_KEY_RIGHT],
          .up = io.KeysDown[GLFW_KEY_UP],
          .down = io.KeysDown[GLFW_KEY_DOWN],
          .press = io.KeysDown[GLFW_KEY_SPACE],
          .wheel = (pressed(GLFW_KEY_PAGE_UP) ? 1.0 : 0.0) - (pressed(GLFW_KEY_PAGE_DOWN) ? 1.0 : 0.0)};
}

void SculptWindow::pointer(const PictureArea& area) {
  const ImGuiIO& io = ImGui::GetIO();
  const ImVec2 by = io.DisplayFramebufferScale;
  model_.view.resize(static_cast<int>(area.width * by.x), static_cast<int>(area.height * by.y));
  PointerInput& input = model_.pointer;
  input = pointerInput(area, by);
  const PointerKeys keys = pointerKeys();
  model_.keys.take(keys, io.DeltaTime, area.width * by.x, area.height * by.y, input);
  if (keys.any()) frames_after_event_ = std::max(frames_after_event_, 3);
  SculptSide& session = model_.session;
  const ViewFrame& frame = session.frame();
  model_.request = model_.gestures.take(input, frame, model_.view, model_.settings.brush, model_.settings.reach);
  lead_.lead(session, model_.request, model_.gestures.kind(), input, model_.settings.reach, session.tick());
  showView();
  adviseOnBrush();
}

// Not while a slider or the mouse still changes it.
void SculptWindow::adviseOnBrush() {
  const bool rests = model_.gestures.kind() == Gestures::Kind::kNone && !ImGui::IsAnyItemActive();
  const std::string words = brush_advice_.take(model_.settings.brush, model_.session.volume().lattice, rests);
  if (!words.empty()) model_.say(words);
}

// A new request where camera or style have changed. A style that is refused leaves the picture as it is.
void SculptWindow::showView() {
  ViewRequest wanted{model_.view.camera(), {}, DrawOrder::kCoarseFirst};
  const SeenVolume& volume = model_.session.volume();
  try {
    wanted.style = styleOf(model_.sight, volume.lattice, volume.size);
  } catch (const Error& error) {
    if (std::exchange(style_refusal_, error.what()) != error.what()) model_.say(error.what());
    if (!asked_) return;
    wanted.style = asked_->style;
  }
  if (asked_ && *asked_ == wanted) return;
  style_refusal_.clear();
  asked_ = std::move(wanted);
  model_.session.show(*asked_);
  frames_after_event_ = std::max(frames_after_event_, 30);
}

}  // namespace palpate
