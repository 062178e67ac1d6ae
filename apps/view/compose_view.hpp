// SPDX-License-Identifier: Apache-2.0
// apps/view/compose_view.hpp: view.png: a run's path, contacts and forces in two panels, the whole object and the
// contact.
//
// Use: get the panels' sizes from layOutView(), choose cameras by framing.hpp, render both pictures, call
// composeView(). Set-up code, any thread (one call at a time per picture). Cost: some ten milliseconds.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "apps/report/touch_run.hpp"
#include "apps/view/contact_region.hpp"
#include "base/camera.hpp"

namespace palpate {

struct PanelBox {
  int x = 0, y = 0, width = 0, height = 0;  // in the whole picture [pixel]
};

struct ViewLayout {
  int width = 0, height = 0;  // of the whole picture [pixel]
  PanelBox overview, close_up;
  double scale = 1;  // of lines and letters; 1 at 1280x720
};

struct ViewPictures {
  Camera overview_camera, close_up_camera;
  RenderedImage overview, close_up;
};

// Refuses (Error kBadInput) less than 480 x 270 pixels and more than 16384 along a side.
[[nodiscard]] ViewLayout layOutView(int width, int height);

// Bytes of a PNG of the layout's size. Refuses (Error kBadInput) pictures whose size is not that of their panel.
// `between` is called again and again while the file is made, and may throw to cancel.
[[nodiscard]] std::string composeView(const ViewLayout& layout, const ViewPictures& pictures,
                                      const ContactRegion& region, const TouchRun& run,
                                      const std::function<void()>& between = {});

}  // namespace palpate
