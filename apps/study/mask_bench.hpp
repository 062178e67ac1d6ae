// SPDX-License-Identifier: Apache-2.0
// apps/study/mask_bench.hpp: `palpate bench masks`: how masks are felt, as they are and through each filter that might
// help, against the exact surface of the body that was masked.
//
// Nothing is timed: every figure is the same on every machine for the same seed. The rows are of part "mask", one for
// each shape, chain and operator. One thread. Throws Error as gpu::Gpu does, and Error(kCancelled) on Ctrl-C.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/bench/benches.hpp"
#include "apps/console/progress.hpp"

namespace palpate {

// What is done to the mask before it is felt.
struct MaskWay {
  std::string chain = {};                   // filters; empty: none
  std::string gradient = {};                // gradient operator; empty: central
  [[nodiscard]] std::string words() const;  // as options of the program
};
[[nodiscard]] std::vector<MaskWay> maskWays();

struct MaskBenchRequest {
  std::vector<std::string> shapes = {};  // by name; empty: all
  std::vector<MaskWay> ways = maskWays();
  std::size_t ticks = 4000;  // of a path
  std::uint64_t seed = 1;
  std::string gpu = {};

  [[nodiscard]] static MaskBenchRequest quick();
};

[[nodiscard]] BenchResult runMaskBench(const MaskBenchRequest& request, Progress& progress);
[[nodiscard]] std::string maskTable(const BenchResult& result);
[[nodiscard]] LogCharts maskCharts(const BenchResult& result);  // angle against place

// Its row in the table of benches.
[[nodiscard]] Bench maskBench();

}  // namespace palpate
