// SPDX-License-Identifier: Apache-2.0
// apps/window/presenter.hpp: shows frames in a window through Vulkan: a picture of the volume, and the panels over it.
//
// The picture was drawn elsewhere, by the engine on a device of its own; here it is copied into the window's image, so
// that neither device waits for the other. One thread, that of the window.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/camera.hpp"
#include "shaders/picture.layout.h"

struct GLFWwindow;
struct ImDrawData;

namespace palpate {

// A picture and its place in the window [pixel of the framebuffer]. What lies outside the window is cut.
struct PlacedPicture {
  const std::vector<layout::PicturePixel>* pixels = nullptr;  // rows from the top; null: none
  int width = 0, height = 0;
  int x = 0, y = 0;
};

class Presenter {
 public:
  // Needs an ImGui context with its platform backend; makes its renderer. `gpu`: part of the name of the device to show
  // with; where that cannot show, another is taken. Throws Error(kDevice) where none can.
  Presenter(GLFWwindow* window, const std::string& gpu);
  ~Presenter();
  Presenter(const Presenter&) = delete;
  Presenter& operator=(const Presenter&) = delete;

  [[nodiscard]] const std::string& device() const noexcept;

  // Shows one frame: the background in this colour (0 to 1), also where the picture shows nothing, and the panels.
  // Returns false, and shows nothing, while the window takes no frames (it is hidden or being resized). Waits for the
  // display where it is slower. A surface that is lost is made anew. Throws Error(kDevice).
  bool present(const float (&background)[3], const PlacedPicture& picture, ImDrawData* panels);
  // Like present(), and returns what is shown.
  [[nodiscard]] std::optional<RenderedImage> capture(const float (&background)[3], const PlacedPicture& picture,
                                                     ImDrawData* panels);
  void renewFonts();  // after the atlas has changed

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace palpate
