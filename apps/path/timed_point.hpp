// SPDX-License-Identifier: Apache-2.0
// apps/path/timed_point.hpp: the points of a scripted path with their times, and its named phases.
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
