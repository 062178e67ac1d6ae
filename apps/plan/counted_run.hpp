// SPDX-License-Identifier: Apache-2.0
// apps/plan/counted_run.hpp: runs a scene in a process of its own and reads from its summary what it had done, held and
// loaded. A process of its own, since libraries stay loaded and pipelines made. Set-up code; one thread, which waits.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/scene/scene.hpp"
#include "base/measured.hpp"
#include "engine/gpu/gpu_use.hpp"

namespace palpate {

struct RunCounts {
  std::string vulkan_device;
  gpu::GpuUse gpu;
  std::vector<std::string> threads;    // while the servo ran
  std::vector<std::string> libraries;  // at the end
  std::vector<StageTime> stages;
  std::int64_t effect_runs = 0;
  double start_ms = 0;           // from the start of the process until the first tick was due
  double tick_us = 0;            // computing time of a tick in contact or not, median; 0 with the simulated clock
  double wall_ms = 0;            // of the whole process, seen from outside
  std::uint64_t main_bytes = 0;  // of main memory, the process's peak [byte]
  std::vector<std::string> plan;

  [[nodiscard]] std::uint64_t dispatches() const noexcept;
  [[nodiscard]] std::size_t ownThreads() const;  // of Palpate (purposes.hpp), not of a driver
};

// The scene as it is run for counting, by the real clock for a fifth of a second, with the simulated device whatever
// the scene names. Everything that it writes goes into `folder`. A path from a file of more than two seconds is left
// out for one that is built from the surface.
[[nodiscard]] Scene shortRun(Scene scene, const std::filesystem::path& folder);

// Runs shortRun(scene, folder) with `program` (this one, if empty). `folder`: one of the caller's own; what an earlier
// run left there goes. Throws Error with the program's own message and the code that its status stands for; kDevice if
// it crashed; kIo if no process can be started; kCancelled on Ctrl-C.
[[nodiscard]] RunCounts countedRun(const Scene& scene, const std::filesystem::path& folder,
                                   const std::string& program = {});

}  // namespace palpate
