// SPDX-License-Identifier: Apache-2.0
// engine/volume/recovered_vdb.hpp: a volume as the bytes of an OpenVDB file: one grid "density" of floats in
// millimetres, as loadVolume reads them. Any thread, while nobody changes the volume. Memory: as much as the file.
#pragma once

#include <string>

#include "engine/volume/volume.hpp"

namespace palpate {

// Throws Error(kBadInput) where voxels are too small for OpenVDB in millimetres.
[[nodiscard]] std::string vdbBytes(const Volume& volume);

}  // namespace palpate
