// SPDX-License-Identifier: Apache-2.0
// apps/bench/resident_chain.hpp: a chain of filters that is ready to run over a whole volume: its pools are allocated
// and its kernels compiled, as after an edit that reaches every brick. Thread: the Gpu's.
#pragma once

#include <cstddef>
#include <numeric>
#include <vector>

#include "apps/rivals/rivals.hpp"
#include "engine/filter_passes/filter_chain.hpp"

namespace palpate {

class ResidentChain {
 public:
  ResidentChain(gpu::Gpu& gpu, gpu::Transfer& transfer, const BrickPool& source, std::vector<FilterStep> steps)
      : source_(source),
        chain_(gpu, transfer, source, std::move(steps)),
        commands_(gpu, "filters", chain_.dispatches()),
        bricks_(source.brickCount()) {
    std::iota(bricks_.begin(), bricks_.end(), 0U);
  }

  void plan() {  // before record()
    chain_.plan(bricks_, [&](std::uint32_t brick) { return source_.constantOf(brick); });
    chain_.commit();
  }
  void record(gpu::Commands& commands) { chain_.record(commands); }  // all steps
  void settle() { chain_.settle(); }                                 // after the commands have run
  RunCost run() {                                                    // plan, record, run and settle
    return costOf([&] {
      plan();
      commands_.begin();
      record(commands_);
      commands_.run();
      settle();
    });
  }

  [[nodiscard]] std::size_t passes() const noexcept { return chain_.steps().size(); }
  [[nodiscard]] std::uint32_t dispatches() const noexcept { return chain_.dispatches(); }
  [[nodiscard]] const BrickPool& result() const noexcept { return chain_.result(); }
  [[nodiscard]] double movedBytes() const {  // bytes that all passes read and write, each field once
    double fields = 0;
    for (const FilterStep& step : chain_.steps()) {
      fields += step.kind == StepKind::kDistanceFinish ? 3 : 2;  // it reads surface points and densities
    }
    return fields * kBrickVoxels * sizeof(float) * static_cast<double>(source_.storedBricks());
  }

 private:
  const BrickPool& source_;
  FilterChain chain_;
  gpu::Commands commands_;
  std::vector<std::uint32_t> bricks_;  // all
};

}  // namespace palpate
