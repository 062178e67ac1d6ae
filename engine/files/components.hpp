// SPDX-License-Identifier: Apache-2.0
// engine/files/components.hpp: the Error for files whose voxels hold several numbers each; every format words it the
// same. Private to engine/files. Any thread.
#pragma once

#include <string>

namespace palpate {

enum class Components { kColours, kVectors, kColoursOrVectors, kComplex, kTensors };

// Throws Error(kBadInput): "SOURCE: its voxels are colours of 3 components, and a density is one number; ...". `count`:
// numbers in each voxel. `whose`: the words of the message for what holds them.
[[noreturn]] void refuseComponents(const std::string& source, Components kind, double count,
                                   const std::string& whose = "its voxels");

}  // namespace palpate
