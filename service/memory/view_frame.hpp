// SPDX-License-Identifier: Apache-2.0
// service/memory/view_frame.hpp: a picture of a volume that is being edited, as it is handed to a window.
#pragma once

#include <cstdint>
#include <vector>

#include "base/camera.hpp"
#include "shaders/picture.layout.h"

namespace palpate {

struct ViewFrame {
  std::uint64_t number = 0;                  // from 1; 0: nothing is drawn yet
  std::uint64_t request = 0;                 // that it belongs to, as LiveView::show() numbers them
  Camera camera;                             // that the pixels belong to
  std::vector<layout::PicturePixel> pixels;  // rows from the top
  std::uint64_t edit_version = 0;            // every edit up to this one is seen
  bool fine = false;                         // at full quality
  bool whole = false;                        // and of the volume as it was when the frame was handed over
};

}  // namespace palpate
