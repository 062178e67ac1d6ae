// SPDX-License-Identifier: Apache-2.0
// apps/bench/asked_edits.hpp: asks for edits beside a tool that goes along a way, from a thread of its own, and notes
// when it asked for each.
//
// An edit is a ball of 3 voxels around the place where the tool is about. Every other one fills, the others clear, by a
// tenth of the way. The first is asked for at once and made with the servo's first ticks, however long the servo takes
// to start; it only sets the clock. The others follow at times from then on, 15 to 35 ms apart; they are random, and
// the same for the same seed. World frame W [m].
#pragma once

#include <cstdint>
#include <thread>
#include <vector>

#include "apps/bench/service_figures.hpp"
#include "apps/rig/rig_edits.hpp"
#include "servo/devices/path.hpp"

namespace palpate {

class AskedEdits {
 public:
  struct Plan {
    double begin_s = 0.1;      // of the others, after the first is made
    double end_s = 1;          // of asking, likewise
    double voxel_m = 1e-3;     // [m]
    std::uint64_t before = 0;  // the volume's edits until now (Engine::editVersion)
    std::uint64_t seed = 1;
  };
  // Starts the thread, before the servo. Nobody else has asked `edits` for anything, or does. Both outlive this.
  AskedEdits(RigEdits& edits, const Path& way, const Plan& plan);

  // Waits for the thread, which stops asking. Then: all that were asked for but the first, in order. Once.
  [[nodiscard]] std::vector<AskedEdit> take();

 private:
  bool askAt(double way_s);
  void ask(const std::stop_token& stop);

  RigEdits& edits_;
  const Path& way_;
  const Plan plan_;
  std::vector<AskedEdit> asked_;
  std::jthread thread_;  // last member: it uses the others
};

}  // namespace palpate
