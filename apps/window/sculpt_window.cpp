// SPDX-License-Identifier: Apache-2.0
#include "apps/window/sculpt_window.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <imgui.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "apps/console/interrupt.hpp"
#include "apps/sculpt/session_folders.hpp"
#include "apps/sculpt/user_folders.hpp"
#include "apps/window/gui_host.hpp"
#include "apps/window/panels.hpp"
#include "base/error.hpp"
#include "base/units.hpp"

namespace palpate {
namespace {

constexpr double kFrame_s = 1.0 / 60;
constexpr double kIdle_s = 0.1;  // between two frames in which nothing happens: plots and figures go on

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

// `by_x`, `by_y`: pixels of the picture per unit of ImGui.
PointerInput pointerInput(const PictureArea& area, float by_x, float by_y) {
  const ImGuiIO& io = ImGui::GetIO();
  PointerInput input;
  input.x = (io.MousePos.x - area.x) * by_x;
  input.y = (io.MousePos.y - area.y) * by_y;
  input.dx = io.MouseDelta.x * by_x;
  input.dy = io.MouseDelta.y * by_y;
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

class SculptWindow {
 public:
  SculptWindow(GuiHost& host, SculptSession& session, SculptSettings settings)
      : host_(host),
        model_{
            .session = session, .settings = std::move(settings), .view = OrbitView(session.volume().object, 640, 480)},
        tool_(model_.view.distance_m()) {
    model_.style.occlusion = true;
  }

  void run() {
    while (!done()) {
      const bool busy = model_.gestures.kind() != Gestures::Kind::kNone || frames_after_event_ > 0;
      if (host_.listen(busy ? kFrame_s / 2 : kIdle_s)) frames_after_event_ = 3;
      frames_after_event_ = std::max(0, frames_after_event_ - 1);
      frame();
    }
  }

  [[nodiscard]] const SculptSettings& settings() const noexcept { return model_.settings; }

 private:
  [[nodiscard]] bool done() {
    if (interrupted() || (model_.closes && model_.state.errands == 0)) return true;
    if (!host_.wantsToClose()) return false;
    host_.refuseToClose();
    if (!model_.session.look().unsaved) return true;
    model_.asks_to_close = true;
    return false;
  }

  void frame() {
    look();
    host_.begin();
    keys();
    const double scale = host_.scale();
    const PictureArea area = showPanels(model_, scale);
    const ImVec2 by = ImGui::GetIO().DisplayFramebufferScale;
    pointer(area, by.x, by.y);
    showOverlay(model_, area, scale);
    const ViewFrame& picture = model_.session.view().latest();
    const PlacedPicture placed{picture.number == 0 ? nullptr : &picture.pixels, picture.camera.width,
                               picture.camera.height, static_cast<int>(area.x * by.x), static_cast<int>(area.y * by.y)};
    host_.end(placed);
  }

  void look() {
    model_.state = model_.session.look();
    for (const std::string& message : model_.state.messages) model_.say(message);
    ticks_.clear();
    model_.session.takeTicks(ticks_);
    // A point of the plots for each so many ticks: the largest of them.
    for (const TickRecord& tick : ticks_) {
      peak_.force = std::max(peak_.force, asVec3(tick.force_W).norm());
      peak_.depth = std::max(peak_.depth, tick.in_contact ? tick.depth_m : 0);
      peak_.cost = std::max(peak_.cost, tick.tick_cost_ns * 1e-3);
      peak_.lateness = std::max(peak_.lateness, static_cast<double>(tick.lateness_ns) * 1e-3);
      peak_.age = std::max(peak_.age, static_cast<double>(tick.window_age_ns) * 1e-6);
      if (tick.tick % 10 != 9) continue;
      model_.force_N.add(static_cast<float>(peak_.force));
      model_.depth_mm.add(static_cast<float>(peak_.depth * kMillimetresPerMetre));
      model_.cost_us.add(static_cast<float>(peak_.cost));
      model_.lateness_us.add(static_cast<float>(peak_.lateness));
      model_.window_age_ms.add(static_cast<float>(peak_.age));
      peak_ = {};
    }
    model_.tick = model_.session.tick();
  }

  void keys() {
    const ImGuiIO& io = ImGui::GetIO();
    if (io.KeyCtrl && pressed(GLFW_KEY_Z)) io.KeyShift ? model_.session.redo() : model_.session.undo();
    if (io.KeyCtrl && pressed(GLFW_KEY_S)) save();
    if (io.KeyCtrl) return;
    for (int axis = 0; axis < 3; ++axis) {
      if (!pressed(GLFW_KEY_X + axis)) continue;
      std::optional<int>& mirror = model_.settings.brush.mirror_axis;
      mirror = mirror == axis ? std::nullopt : std::optional(axis);
    }
  }

  void save() {
    if (model_.file[0] == '\0') return model_.say("name a file first, at the top left");
    try {
      model_.session.save(model_.file);
    } catch (const Error& error) {
      model_.say(error.what());
    }
  }

  void pointer(const PictureArea& area, float by_x, float by_y) {
    model_.view.resize(static_cast<int>(area.width * by_x), static_cast<int>(area.height * by_y));
    const PointerInput input = pointerInput(area, by_x, by_y);
    SculptSession& session = model_.session;
    const ViewFrame& frame = session.view().latest();
    model_.request = model_.gestures.take(input, frame, model_.view, model_.settings.brush, model_.settings.reach);
    if (model_.request.begins) session.press(*model_.request.begins);
    if (model_.request.ends) session.release();
    const auto kind = model_.gestures.kind();
    if (kind == Gestures::Kind::kStroke || (kind == Gestures::Kind::kNone && input.over)) {
      if (const auto hip_W = tool_.hip_W(frame, input.x, input.y, model_.request.presses, model_.settings.reach))
        session.aim(*hip_W);
    } else if (const auto resting_W = tool_.resting_W(frame)) {
      session.aim(*resting_W);
    }
    showView();
  }

  // A new request where camera or style have changed.
  void showView() {
    const Camera camera = model_.view.camera();
    const bool same = asked_ && asked_->camera.position_W == camera.position_W && asked_->camera.up_W == camera.up_W &&
                      asked_->camera.forward_W == camera.forward_W && asked_->camera.width == camera.width &&
                      asked_->camera.height == camera.height && asked_->style.occlusion == model_.style.occlusion;
    if (same) return;
    asked_ = ViewRequest{camera, model_.style, DrawOrder::kCoarseFirst};
    model_.session.view().show(*asked_);
    frames_after_event_ = std::max(frames_after_event_, 30);
  }

  struct Peak {
    double force = 0, depth = 0, cost = 0, lateness = 0, age = 0;
  };

  GuiHost& host_;
  WindowModel model_;
  PointerTool tool_;
  std::optional<ViewRequest> asked_;
  std::vector<TickRecord> ticks_;
  Peak peak_;
  int frames_after_event_ = 60;
};

// Some words in the middle of an empty window, with buttons below. Returns the number of the one that was pressed;
// without any, returns at once. Empty: the window shall close.
std::optional<std::size_t> ask(GuiHost& host, const std::string& words, const std::vector<std::string>& buttons) {
  constexpr int kShown = 3;  // frames until all of it is on the display
  for (int frame = 0;; ++frame) {
    static_cast<void>(host.listen(frame < kShown ? 0 : kIdle_s));
    if (host.wantsToClose() || interrupted()) return std::nullopt;
    std::optional<std::size_t> pressed_one;
    host.begin();
    ImGui::SetNextWindowPos(ImGui::GetMainViewport()->GetCenter(), ImGuiCond_Always, ImVec2(0.5F, 0.5F));
    if (ImGui::Begin("question", nullptr,
                     ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_AlwaysAutoResize)) {
      ImGui::TextUnformatted(words.c_str());
      for (std::size_t i = 0; i < buttons.size(); ++i) {
        if (i > 0) ImGui::SameLine();
        if (ImGui::Button(buttons[i].c_str())) pressed_one = i;
      }
    }
    ImGui::End();
    host.end({});
    if (pressed_one || (buttons.empty() && frame >= kShown)) return pressed_one.value_or(0);
  }
}

bool isSameVolume(const std::string& left, const std::string& asked) {
  if (left == asked) return true;
  std::error_code unknown;
  return std::filesystem::equivalent(left, asked, unknown);
}

// What becomes of a session of this volume that a crash has left. Returns whether the window shall open.
bool recover(GuiHost& host, const std::filesystem::path& root, SculptRequest& request,
             std::optional<LeftSession>& from) {
  for (const LeftSession& left : leftSessions(root)) {
    if (!isSameVolume(left.volume, request.volume)) continue;
    const std::string words = fmt::format(
        "A session of {} was not closed.\nIts journal has {} {} that no file may hold.{}", request.volume, left.edits,
        left.edits == 1 ? "edit" : "edits", left.damage.empty() ? "" : "\nLost: " + left.damage);
    const auto choice = ask(host, words, {"Make them again", "Begin anew, keep the journal", "Throw them away"});
    if (!choice) return false;
    if (*choice == 0) {
      request.recovers = left.folder;
      from = left;
    }
    if (*choice == 2) dropLeftSession(left);
    if (*choice < 2) break;
  }
  return true;
}

}  // namespace

void runSculptWindow(const SculptRequest& asked, Progress& progress) {
  SculptRequest request = asked;
  const std::filesystem::path folder = settingsFolder();
  const std::filesystem::path file = folder.empty() ? folder : folder / "sculpt.json";
  std::string trouble;
  SculptSettings settings = readSettings(file, trouble);
  settings.opened(request.volume);
  GuiHost host({.title = "Palpate: " + request.volume,
                .width = settings.width,
                .height = settings.height,
                .gpu = request.gpu,
                .dark = settings.dark,
                .scale = settings.scale});
  const KeptWork kept;  // a signal closes the window in good order
  const std::filesystem::path root = journalsFolder();
  std::optional<LeftSession> left;
  std::optional<SessionFolder> journal;
  if (!root.empty()) {
    if (!recover(host, root, request, left)) return;
    journal.emplace(root);
    request.journal = journal->path();
  }
  if (!ask(host, "Loading " + request.volume + " ...", {})) return;
  SculptSession session(request, progress);
  session.start();
  if (left) dropLeftSession(*left);  // its edits are in the new journal
  SculptWindow window(host, session, settings);
  window.run();
  session.close();
  if (!file.empty()) writeSettings(window.settings(), file);
}

}  // namespace palpate
