// SPDX-License-Identifier: Apache-2.0
// servo/window/tool_pose.hpp: position, velocity and force of the tool, from the servo to the engine.
//
// The engine puts the next window around the tool, and the tool may be a brush that edits. Frame W: world [m, m/s, N].
// Threads: the servo publishes every tick, the engine reads; wait-free on both sides.
#pragma once

#include <cstdint>

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
};

using ToolPoseMailbox = TripleBuffer<ToolPose>;

}  // namespace palpate
