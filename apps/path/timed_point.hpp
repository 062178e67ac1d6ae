// SPDX-License-Identifier: Apache-2.0
// apps/path/timed_point.hpp: the points of a scripted path with their times, its named phases, and the brushes that its
// tool holds.
#pragma once

#include <string>

#include "base/vec.hpp"

namespace palpate {

struct TimedPoint {
  double time_s = 0;        // since the path began [s]
  Vec3 p_W = Vec3::Zero();  // world [m]
};

// From this time on the tool edits with this brush, as `palpate touch --edit` takes it; empty: with none.
struct HeldBrush {
  double begin_s = 0;  // since the path began [s]
  std::string text;
};

struct PathPhase {
  std::string name;    // "approach", "press", "slide", "retreat"
  double begin_s = 0;  // [s]
  double end_s = 0;    // [s]
};

}  // namespace palpate
