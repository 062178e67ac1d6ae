// SPDX-License-Identifier: Apache-2.0
// apps/bench/service_run.hpp: the runs of the service bench. A servo feels a phantom along a way, in this process or in
// one of its own as with `palpate touch --service`, while edits are asked for beside it.
//
// All runs are alike: the same phantom, way, device and edits, by the same seed. The tool is a simulated device in a
// rigid hand, 1 voxel below the surface. Edits lie around it and fill and clear in turns, a little each, at times that
// are left to chance, so that they fall into all moments of the engine's and the servo's rounds.
//
// Threads: one makes and runs it and waits; a run has the servo's, the engine's and one that asks for edits. Cost: the
// run's time, and an engine of its own.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "apps/bench/service_figures.hpp"
#include "apps/scene/scene.hpp"
#include "engine/field/volume.hpp"
#include "servo/devices/path.hpp"

namespace palpate {

enum class Processes { kOne, kTwo };
[[nodiscard]] const char* wordFor(Processes processes) noexcept;  // "one", "two"

struct ServiceRun {
  LoopResult loop;
  std::vector<AskedEdit> asked;
};

class ServiceRuns {
 public:
  // `volume`: a phantom. `seconds`: of each run. Throws Error as makePhantom() and contactPath() do.
  ServiceRuns(const std::string& volume, double seconds, std::uint64_t seed, const std::string& gpu,
              std::string commit);

  // By the real clock. Throws Error: as Engine, TouchServo and EditSession do (kNotFound where `palpate-servo` does not
  // lie beside this program); kDevice where an edit was refused; kCancelled on Ctrl-C.
  [[nodiscard]] ServiceRun run(Processes processes);
  // "name, driver" of the last run's Vulkan device; "none" before.
  [[nodiscard]] const std::string& vulkanDevice() const noexcept { return vulkan_device_; }
  [[nodiscard]] double rate_hz() const noexcept { return scene_.rate_hz; }

 private:
  Scene scene_;
  std::uint64_t seed_;
  std::string commit_;
  std::optional<Volume> volume_;  // edits change the engine's, not this one
  std::optional<SampledPath> way_;
  double isovalue_ = 0;
  std::string vulkan_device_ = "none";
};

}  // namespace palpate
