// SPDX-License-Identifier: Apache-2.0
// tests/damage/vdb_grids.hpp: an OpenVDB file as other programs write it. Linux. One thread.
#pragma once

#include <string>

namespace palpate::damage {

// Three grids, a density, a mask and a distance, the same bytes every time.
void writeVdbGrids(const std::string& path);

}  // namespace palpate::damage
