// SPDX-License-Identifier: Apache-2.0
// apps/bench/resident_chain.hpp: a chain of filters over a whole volume with everything at hand: pools that the last
// run left, kernels that are compiled: as after an edit that reaches every brick. Thread: the Gpu's.
#pragma once

#include <cstddef>
#include <vector>

#include "apps/rivals/rival.hpp"
#include "engine/filter_passes/filter_chain.hpp"

namespace palpate {

class ResidentChain {
 public:
  ResidentChain(gpu::Gpu& gpu, gpu::Transfer& transfer, const BrickPool& source, std::vector<FilterStep> steps);

  void plan();                           // before record()
  void record(gpu::Commands& commands);  // all steps
  void settle();                         // when they are done
  RunCost run();                         // all of it, planning included

  [[nodiscard]] std::size_t passes() const noexcept { return chain_.steps().size(); }
  [[nodiscard]] std::uint32_t dispatches() const noexcept { return chain_.dispatches(); }
  [[nodiscard]] double movedBytes() const;  // what all passes read and write, each once
  [[nodiscard]] const BrickPool& result() const noexcept { return chain_.result(); }

 private:
  const BrickPool& source_;
  FilterChain chain_;
  gpu::Commands commands_;
  std::vector<std::uint32_t> bricks_;  // all
};

}  // namespace palpate
