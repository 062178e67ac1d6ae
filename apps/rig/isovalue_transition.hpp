// SPDX-License-Identifier: Apache-2.0
// apps/rig/isovalue_transition.hpp: the engine's steps from one isovalue to another while the servo runs. The engine
// computes the new samples and publishes a window with them. The servo goes over. Then the engine frees the samples of
// the last isovalue.
//
// Isovalues are [density], rounded to float. Thread: the engine's. Cost of a step: that of Engine::beginIsovalue,
// gatherIsovalue or endIsovalue, or nothing.
#pragma once

#include <cstdint>

#include "base/portion_size.hpp"
#include "engine/service/engine.hpp"

namespace palpate {

class IsovalueTransition {
 public:
  explicit IsovalueTransition(Engine& engine) : engine_(engine) {}

  struct Look {
    double wanted = 0;              // the isovalue to go to; it may change at any time
    double in_use = 0;              // the isovalue that the servo was given last
    std::uint64_t window_seen = 0;  // version of the window that the servo's last tick read
    bool taken = false;             // the servo has gone over to `in_use` and dropped the algorithm before it
    bool all_at_once = false;       // samples are computed in one go; else in portions of some kPortion_s
  };
  // Whether the servo may now be given the wanted isovalue: it has read a window with the new samples. If this returns
  // true, the caller must give it. Never waits.
  [[nodiscard]] bool mayGive(const Look& look) noexcept;
  // Does the next step. Throws Error as the engine does. If the engine refuses the isovalue, a later call may begin
  // anew.
  void work(const Look& look, std::int64_t now_ns);
  // To be called when nobody reads samples any more: frees all but those of `in_use`.
  void end(double in_use);

  static constexpr double kPortion_s = 2e-3;  // windows follow the tool in between [s]

 private:
  void gather(const Look& look, std::int64_t now_ns);

  enum class At {
    kStart,
    kGathering,  // the engine computes samples
    kShown,      // a window with the new samples is published; the servo may not have read it yet
    kTaking,     // the servo goes over; it still reads the samples of the last isovalue
  };
  static constexpr std::uint32_t kMostBricks = 65536;  // of a portion

  Engine& engine_;
  At at_ = At::kStart;
  double next_ = 0;          // the isovalue that the engine goes to
  std::uint64_t shown_ = 0;  // version of the first window with its samples
  PortionSize portion_{kMostBricks, kPortion_s};
};

}  // namespace palpate
