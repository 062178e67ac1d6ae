// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/full_recompute.hpp"

#include "base/stopwatch.hpp"
#include "engine/bricks/active_bricks.hpp"
#include "engine/passes/gpu_budget.hpp"
#include "engine/service/engine.hpp"
#include "servo/window/sample_window.hpp"

namespace palpate {

FullRecompute::FullRecompute(const Volume& volume, double isovalue, bool all_gradients, const std::string& gpu)
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
  compute();
}

std::vector<std::uint32_t> FullRecompute::bricks() {
  bounds_.run();
  if (all_) return allBricks(pool_.grid());
  return activeBricks(bounds_.read(transfer_), pool_.grid(), isovalue_);
}

// The needed bricks are found each time, as after an edit that may have changed any.
void FullRecompute::compute() {
  static_cast<void>(bricks());
  gradient_.run();
  window_.run(box_, buffer_);
}

void FullRecompute::run() {
  const Stopwatch watch;
  compute();
  times_ms_.push_back(1e3 * watch.seconds());
}

}  // namespace palpate
