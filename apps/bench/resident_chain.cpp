// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/resident_chain.hpp"

#include <numeric>

namespace palpate {

ResidentChain::ResidentChain(gpu::Gpu& gpu, gpu::Transfer& transfer, const BrickPool& source,
                             std::vector<FilterStep> steps)
    : source_(source),
      chain_(gpu, transfer, source, std::move(steps)),
      commands_(gpu, "filters", chain_.dispatches()),
      bricks_(source.brickCount()) {
  std::iota(bricks_.begin(), bricks_.end(), 0U);
}

void ResidentChain::plan() {
  chain_.plan(bricks_, [&](std::uint32_t brick) { return source_.constantOf(brick); });
  chain_.commit();
}

void ResidentChain::record(gpu::Commands& commands) {
  chain_.record(commands);
}

void ResidentChain::settle() {
  chain_.settle();
}

RunCost ResidentChain::run() {
  return costOf([&] {
    plan();
    commands_.begin();
    record(commands_);
    commands_.run();
    settle();
  });
}

double ResidentChain::movedBytes() const {
  constexpr double kBrickBytes = kBrickVoxels * sizeof(float);
  double fields = 0;
  for (const FilterStep& step : chain_.steps()) {
    fields += step.kind == StepKind::kDistanceFinish ? 3 : 2;  // which reads surface points and densities
  }
  return fields * kBrickBytes * static_cast<double>(source_.storedBricks());
}

}  // namespace palpate
