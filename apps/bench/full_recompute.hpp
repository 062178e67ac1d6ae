// SPDX-License-Identifier: Apache-2.0
// apps/bench/full_recompute.hpp: times the alternative to an edit: computing everything anew. That is the bounds, the
// active bricks, their gradients (or those of all bricks) and a window. The volume is on the device already. Thread:
// one. Throws Error as Engine does.
#pragma once

#include <string>
#include <vector>

#include "base/stopwatch.hpp"
#include "engine/bricks/active_bricks.hpp"
#include "engine/field/volume.hpp"
#include "engine/passes/brick_bounds_pass.hpp"
#include "engine/passes/brick_pool.hpp"
#include "engine/passes/gradient_pass.hpp"
#include "engine/passes/sample_store.hpp"
#include "engine/passes/slot_slabs.hpp"
#include "engine/passes/window_pass.hpp"
#include "engine/service/engine.hpp"
#include "servo/window/sample_window.hpp"

namespace palpate {

class FullRecompute {
 public:
  // Includes a first run, to warm up.
  FullRecompute(const Volume& volume, double isovalue, bool all_gradients, const std::string& gpu)
      : isovalue_(static_cast<float>(isovalue)),
        all_(all_gradients),
        gpu_(gpu::GpuRequest{.name = gpu}),
        transfer_(gpu_),
        pool_(gpu_, transfer_, volume, makeGpuBudget()),
        bounds_(gpu_, pool_),
        store_(gpu_, pool_.brickCount(), bricks(), pool_.budget()),
        gradient_(gpu_, transfer_, pool_, store_),
        window_(gpu_, pool_, store_),
        box_(windowAround((pool_.size() / 2).cast<double>(), pool_.size())),
        buffer_(gpu_, "window", static_cast<std::size_t>(box_.size.prod()) * sizeof(Sample), gpu::MemoryKind::kHost) {
    static_cast<void>(run_ms());
  }

  [[nodiscard]] double run_ms() {
    const Stopwatch watch;
    static_cast<void>(bricks());  // finds them again: an edit may have changed any brick
    gradient_.run();
    window_.run(box_, buffer_);
    return 1e3 * watch.seconds();
  }

 private:
  [[nodiscard]] std::vector<std::uint32_t> bricks() {  // the bricks that have samples
    bounds_.run();
    if (all_) return allBricks(pool_.grid());
    return activeBricks(bounds_.read(transfer_), pool_.grid(), isovalue_);
  }

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
};

}  // namespace palpate
