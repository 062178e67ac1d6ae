// SPDX-License-Identifier: Apache-2.0
// apps/path/timed_point.hpp: a scripted path: where the tool is at which time, and what its parts are called.
#pragma once

#include <string>

#include "base/vec.hpp"

namespace palpate {

struct TimedPoint {
  double time_s = 0;        // since the path began [s]
  Vec3 p_W = Vec3::Zero();  // world [m]
};

struct PathPhase {
  std::string name;    // "approach", "press", "slide", "retreat"
  double begin_s = 0;  // [s]
  double end_s = 0;    // [s]
};

}  // namespace palpate
