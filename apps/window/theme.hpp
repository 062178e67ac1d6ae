// SPDX-License-Identifier: Apache-2.0
// apps/window/theme.hpp: colours and spacing of the window, dark and light. The colours of what is drawn over the
// picture differ for colour-blind people too (Okabe and Ito 2008). One thread.
#pragma once

#include <cstdint>

namespace palpate {

void applyTheme(bool dark, double scale);
// Behind panels and picture, 0 to 1.
[[nodiscard]] const float (&background(bool dark) noexcept)[3];

// As ImGui has them: red in the lowest byte.
struct OverlayColours {
  std::uint32_t tool, surface_point, force, brush, outline;
};
[[nodiscard]] const OverlayColours& overlayColours() noexcept;

}  // namespace palpate
