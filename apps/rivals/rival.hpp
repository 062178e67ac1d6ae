// SPDX-License-Identifier: Apache-2.0
// apps/rivals/rival.hpp: a filter or gradient of another library on the volume that Palpate has too, ready to be timed.
//
// A job is what Palpate is asked for, as text: "gaussian:1.5", "gradient central". A library that has something alike
// offers one or more rivals for it and says in `way` what it runs and how that differs. One thread calls them; each
// takes as many threads as it was made for, or says that it takes one.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/vec.hpp"

namespace palpate {

// The volume, which the caller keeps while rivals live.
struct RivalField {
  Vec3i size = Vec3i::Zero();        // [voxel]
  Vec3 spacing_m = Vec3::Zero();     // [m]; libraries are given millimetres
  std::span<const float> densities;  // i fastest
};

// What a run took.
struct RunCost {
  double wall_ms = 0;
  double cpu_ms = 0;  // of all threads of the process that ran it
};

struct Rival {
  std::string library;  // "ITK"
  std::string way;      // "GradientImageFilter"
  // Runs once: from the volume in memory to a result in memory that is made anew, as the library's users have it.
  // `result`: gets it, unmeasured, i fastest, a gradient's components together; null: it is thrown away. Throws Error.
  std::function<RunCost(std::vector<float>* result)> run;
};

// Wall clock and process CPU time of `work`.
[[nodiscard]] RunCost costOf(const std::function<void()>& work);

}  // namespace palpate
