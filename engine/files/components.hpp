// SPDX-License-Identifier: Apache-2.0
// engine/files/components.hpp: refuses voxels that hold several numbers, in the same words for every format. Private to
// engine/files. Any thread.
#pragma once

#include <string>

namespace palpate {

enum class Components { kColours, kVectors, kColoursOrVectors, kComplex, kTensors };

// Throws Error(kBadInput): "SOURCE: its voxels are colours of 3 components, and a density is one number; ...". `count`:
// numbers a voxel. `whose`: what holds them, in the message.
[[noreturn]] void refuseComponents(const std::string& source, Components kind, double count,
                                   const std::string& whose = "its voxels");

}  // namespace palpate
