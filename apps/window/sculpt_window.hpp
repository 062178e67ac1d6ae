// SPDX-License-Identifier: Apache-2.0
// apps/window/sculpt_window.hpp: the window in which a volume is seen, touched and edited. One thread.
#pragma once

#include <string>

#include "apps/console/progress.hpp"
#include "apps/sculpt/sculpt_session.hpp"

namespace palpate {

// Opens the window and stays until it is closed, or until SIGINT or SIGTERM, which end it as closing does but do not
// ask. Throws Error as GuiHost and SculptSession do.
void runSculptWindow(const SculptRequest& request, Progress& progress);

}  // namespace palpate
