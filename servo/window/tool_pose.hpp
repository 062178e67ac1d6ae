// SPDX-License-Identifier: Apache-2.0
// servo/window/tool_pose.hpp: position, velocity and force of the tool, from the servo to the engine.
//
// The engine puts the next window around the tool, and the tool may be a brush that edits. Frame W: world [m, m/s, N].
// Threads: the servo publishes every tick, the engine reads; wait-free on both sides. The two may be processes that
// share the mailbox's block (a ToolPoseRecord is plain bytes of a fixed layout).
#pragma once

#include <cstdint>
#include <type_traits>

#include "base/vec.hpp"
#include "servo/window/triple_buffer.hpp"

namespace palpate {

struct ToolPose {
  Vec3 position_W = Vec3::Zero();    // HIP, as the servo read it [m]
  Vec3 velocity_W = Vec3::Zero();    // the servo's filtered estimate [m/s]
  std::int64_t tick = -1;            // of the servo; -1: before the first tick
  std::int64_t time_ns = 0;          // on the servo's clock [ns]
  bool at_surface = false;           // the next window belongs around `surface_W`, not around the HIP
  Vec3 surface_W = Vec3::Zero();     // surface point of the contact, if at_surface [m]
  Vec3 normal_W = Vec3::Zero();      // of the contact, out of the object; zero without contact [-]
  Vec3 force_W = Vec3::Zero();       // what the device was sent last, after the safety gate [N]
  std::uint64_t window_version = 0;  // of the window that this tick read; 0: none
  std::uint32_t faults = 0;          // bits of servo/safety/faults.hpp; an overrun is the tick's before
  // How often the tool has been put elsewhere. Between two poses that differ in it the tool leapt: there is no way.
  std::uint32_t leaps = 0;
};

// A pose as it lies in the mailbox.
struct ToolPoseRecord {
  double position_W[3] = {}, velocity_W[3] = {}, surface_W[3] = {}, normal_W[3] = {}, force_W[3] = {};
  std::int64_t tick = -1, time_ns = 0;
  std::uint64_t window_version = 0;
  std::uint64_t at_surface = 0;  // 0 or 1
  std::uint32_t faults = 0, leaps = 0;
};
static_assert(std::is_trivially_copyable_v<ToolPoseRecord> && sizeof(ToolPoseRecord) == 160);
using ToolPoseBlock = TripleBlock<ToolPoseRecord>;
static_assert(sizeof(ToolPoseBlock) == 3 * 192 + 64);

class ToolPoseMailbox {
 public:
  ToolPoseMailbox() = default;
  // One side over a block that neither side has used, and which outlives this.
  explicit ToolPoseMailbox(ToolPoseBlock& shared) noexcept : buffer_(shared) {}

  // Writer: the pose to fill; it holds an older one. publish() hands it over.
  [[nodiscard]] ToolPose& back() noexcept { return back_; }
  void publish() noexcept;

  // Reader: the newest pose that was published, valid until the next call. One that is no place in the world, as no
  // servo writes it, is left out.
  [[nodiscard]] const ToolPose& latest() noexcept {
    if (buffer_.renew()) takeFront();
    return latest_;
  }

 private:
  void takeFront() noexcept;

  TripleBuffer<ToolPoseRecord> buffer_;
  ToolPose back_;                // writer's
  alignas(64) ToolPose latest_;  // reader's, on lines of its own
};

}  // namespace palpate
