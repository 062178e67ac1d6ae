// SPDX-License-Identifier: Apache-2.0
// apps/rig/isovalue_way.hpp: the engine's part in going over to another isovalue while the servo runs: its samples are
// computed, shown to the servo, and those of the last isovalue freed once the servo has gone over.
//
// Isovalues are [density], rounded to float. Thread: whoever the engine belongs to. Cost of a step: that of
// Engine::beginIsovalue, gatherIsovalue or endIsovalue, or nothing.
#pragma once

#include <cstdint>

#include "base/portion_size.hpp"
#include "engine/service/engine.hpp"

namespace palpate {

class IsovalueWay {
 public:
  explicit IsovalueWay(Engine& engine) : engine_(engine) {}

  struct Look {
    double wanted = 0;              // the isovalue to go to; it may change at any time
    double in_use = 0;              // the isovalue that the servo was given last
    std::uint64_t window_seen = 0;  // version of the window that the servo's last tick read
    bool taken = false;             // the servo has gone over to `in_use`, and ended what it had before
    bool all_at_once = false;       // samples are computed in one go; else in portions of some kPortion_s
  };
  // Whether the servo may be given the isovalue that is wanted now: it has seen a window with its samples. Once true,
  // it is being given. Never waits.
  [[nodiscard]] bool mayGive(const Look& look) noexcept;
  // The next step. Throws Error as the Engine does; where it refuses the isovalue, the next call may begin anew.
  void work(const Look& look, std::int64_t now_ns);
  // Where nobody reads samples any more: frees all but those of `in_use`.
  void end(double in_use);

  static constexpr double kPortion_s = 2e-3;  // windows follow the tool in between [s]

 private:
  void gather(const Look& look, std::int64_t now_ns);

  enum class At {
    kStart,
    kGathering,  // the engine computes samples
    kShown,      // a window with them is out; the servo may not have read it yet
    kTaking,     // the servo goes over, and still reads the samples of the last isovalue
  };
  static constexpr std::uint32_t kMostBricks = 65536;  // in a portion

  Engine& engine_;
  At at_ = At::kStart;
  double next_ = 0;          // the isovalue that it is on the way to
  std::uint64_t shown_ = 0;  // version of the first window with its samples
  PortionSize portion_{kMostBricks, kPortion_s};
};

}  // namespace palpate
