// SPDX-License-Identifier: Apache-2.0
// engine/gpu/gpu_use.hpp: what a Gpu has been made to do so far: its pipelines and how often each was dispatched, its
// buffers, its submissions. Counted as it happens, so reports and tests need not believe a plan. Plain data.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace palpate::gpu {

struct KernelUse {
  std::string name = {};                                              // of its shader: "gradient"
  std::vector<std::pair<std::string, std::uint32_t>> constants = {};  // specialisation: "kRun", 8
  double made_s = 0;  // the driver's time for its pipeline; 0 if it was there already [s]
  std::uint64_t dispatches = 0;
};

struct BufferUse {
  std::string name = {};
  std::uint32_t count = 0;  // of this name
  std::uint64_t bytes = 0;  // of all of them [byte]
};

struct GpuUse {
  std::vector<KernelUse> kernels = {};  // in the order in which they were made
  std::vector<BufferUse> buffers = {};  // that are there now, by name
  std::uint64_t submissions = 0;
  std::uint64_t peak_bytes = 0;  // the most that all buffers had at one time [byte]
};

}  // namespace palpate::gpu
