// SPDX-License-Identifier: Apache-2.0
// apps/window/run_window.hpp: `palpate sculpt`: the window from the first volume to the last. One thread.
#pragma once

#include "apps/sculpt/sculpt_session.hpp"

namespace palpate {

// Opens the window and stays until it is closed, or until SIGINT or SIGTERM, which end it as closing does but do not
// ask. Throws Error as openHeldDevice and GuiHost do, and as SculptSession does for the first volume. A later volume
// that cannot be opened is told in the window, and the one that is open stays.
void runWindow(const SculptRequest& request);

}  // namespace palpate
