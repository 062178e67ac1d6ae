// SPDX-License-Identifier: Apache-2.0
// apps/bench/full_recompute.hpp: what an edit would cost if everything were computed anew: bounds, the bricks that the
// isosurface needs, their gradients (or those of all bricks) and a window, of a volume that is on the device already.
// Thread: one. Throws Error as Engine does.
#pragma once

#include <string>
#include <vector>

#include "engine/field/volume.hpp"
#include "engine/passes/brick_bounds_pass.hpp"
#include "engine/passes/brick_pool.hpp"
#include "engine/passes/gradient_pass.hpp"
#include "engine/passes/sample_store.hpp"
#include "engine/passes/window_pass.hpp"

namespace palpate {

class FullRecompute {
 public:
  // The first run, unmeasured, is in here.
  FullRecompute(const Volume& volume, double isovalue, bool all_gradients, const std::string& gpu);

  void run();
  [[nodiscard]] const std::vector<double>& times_ms() const noexcept { return times_ms_; }
  void forget() { times_ms_.clear(); }

 private:
  void compute();
  [[nodiscard]] std::vector<std::uint32_t> bricks();  // that have samples

  float isovalue_;
  bool all_;
  gpu::Gpu gpu_;
  gpu::Transfer transfer_;
  BrickPool pool_;
  BrickBoundsPass bounds_;
  SampleStore store_;
  GradientPass gradient_;
  WindowPass window_;
  WindowBox box_;
  gpu::Buffer buffer_;
  std::vector<double> times_ms_;
};

}  // namespace palpate
