// SPDX-License-Identifier: Apache-2.0
// tests/damage/vdb_grids.hpp: an OpenVDB file as other programs write it. Linux. One thread.
#pragma once

#include <string>

namespace palpate::damage {

// Writes three grids (a density, a mask and a distance), with the same bytes every time.
void writeVdbGrids(const std::string& path);

}  // namespace palpate::damage
