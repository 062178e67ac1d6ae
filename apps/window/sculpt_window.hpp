// SPDX-License-Identifier: Apache-2.0
// apps/window/sculpt_window.hpp: the window of one session: picture, panels, mouse and keys, frame by frame. One
// thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/sculpt/pointer_lead.hpp"
#include "apps/window/gui_host.hpp"
#include "apps/window/panels.hpp"

namespace palpate {

class SculptWindow {
 public:
  // Both outlive it.
  SculptWindow(GuiHost& host, SculptSide& session, SculptSettings settings);

  // Until the window shall close, or another volume is to be opened; SIGINT and SIGTERM close it, and do not ask.
  // Returns the volume to open; empty: none. May be called again: then the session goes on.
  [[nodiscard]] std::string run();

  [[nodiscard]] const SculptSettings& settings() const noexcept { return model_.settings; }
  void say(const std::string& text) { model_.say(text); }

 private:
  [[nodiscard]] bool done();
  void frame();
  void look();
  void record();
  void keys();
  void pointer(const PictureArea& area);
  [[nodiscard]] PointerKeys pointerKeys() const;
  void showView();
  void adviseOnBrush();
  void changeHost();
  void keepScreenshot(const std::optional<RenderedImage>& image);

  struct Peak {
    double force = 0, depth = 0, cost = 0, lateness = 0, age = 0;
  };

  GuiHost& host_;
  WindowModel model_;
  PointerLead lead_;
  std::optional<ViewRequest> asked_;
  std::string style_refusal_;
  BrushAdvice brush_advice_;
  std::vector<TickRecord> ticks_;
  Peak peak_;
  int frames_after_event_ = 60;
};

}  // namespace palpate
