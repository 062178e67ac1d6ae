// SPDX-License-Identifier: Apache-2.0
#include "apps/view/canvas.hpp"

#include "base/module.hpp"

namespace palpate {

std::unique_ptr<Canvas> makeCanvas(int width, int height) {
  return loadModule<CairoModule>().make(width, height);
}

}  // namespace palpate
