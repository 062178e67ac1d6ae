// SPDX-License-Identifier: Apache-2.0
// apps/window/gui_host.hpp: a window of the desktop with panels in it: GLFW, ImGui and the Presenter put together.
//
// One thread, that which made it. At most one at a time.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/window/presenter.hpp"

struct GLFWwindow;

namespace palpate {

struct GuiSettings {
  std::string title = "Palpate";
  int width = 1280, height = 720;  // [screen coordinates]
  std::string gpu;                 // part of the name of the device to show with
  bool dark = true;
  double scale = 0;  // of text and panels; 0: the display's
};

class GuiHost {
 public:
  // Throws Error(kDevice) where there is no display, or none that Vulkan can show on.
  explicit GuiHost(const GuiSettings& settings);
  ~GuiHost();
  GuiHost(const GuiHost&) = delete;
  GuiHost& operator=(const GuiHost&) = delete;

  // Takes what the user did; waits for it up to this time where there is nothing. Returns whether there was anything.
  bool listen(double most_s);
  [[nodiscard]] bool wantsToClose() const;  // since refuseToClose()
  void refuseToClose();
  [[nodiscard]] std::vector<std::string> takeDroppedFiles();
  void setTitle(const std::string& title);
  // Of the window, as GuiSettings has it.
  [[nodiscard]] std::array<int, 2> size() const;
  // Between two frames. `scale`: as in GuiSettings.
  void setDark(bool dark);
  void setScale(double scale);
  [[nodiscard]] double scale() const noexcept;  // pixels of the framebuffer per pixel of a panel at 1x

  // A frame: begin(), panels by ImGui, end(). end() returns false while the window takes no frame.
  void begin();
  bool end(const PlacedPicture& picture);
  // As end(), and what is shown.
  [[nodiscard]] std::optional<RenderedImage> endAndCapture(const PlacedPicture& picture);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace palpate
