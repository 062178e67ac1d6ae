// SPDX-License-Identifier: Apache-2.0
#include "servo/window/tool_pose.hpp"

#include <atomic>

namespace palpate {
namespace {

void put(double (&to)[3], const Vec3& from) noexcept {
  for (int axis = 0; axis < 3; ++axis) to[axis] = from[axis];
}
// Sums and quotients of such numbers are finite. Nothing that a hand holds comes near.
bool isSane(const Vec3& v) noexcept {
  constexpr double kMost = 1e12;
  return v.allFinite() && v.cwiseAbs().maxCoeff() <= kMost;
}
Vec3 taken(const double (&from)[3]) noexcept {
  return {from[0], from[1], from[2]};
}

}  // namespace

void ToolPoseMailbox::publish() noexcept {
  ToolPoseRecord& record = buffer_.back();
  put(record.position_W, back_.position_W);
  put(record.velocity_W, back_.velocity_W);
  put(record.surface_W, back_.surface_W);
  put(record.normal_W, back_.normal_W);
  put(record.force_W, back_.force_W);
  record.tick = back_.tick;
  record.time_ns = back_.time_ns;
  record.window_version = back_.window_version;
  record.at_surface = back_.at_surface ? 1 : 0;
  record.faults = back_.faults;
  record.leaps = back_.leaps;
  buffer_.publish();
}

// The other side may write on while this reads: what is checked is a copy, which the fence keeps the compiler from
// reading anew.
void ToolPoseMailbox::takeFront() noexcept {
  const ToolPoseRecord record = buffer_.front();
  std::atomic_signal_fence(std::memory_order_seq_cst);
  ToolPose pose;
  pose.position_W = taken(record.position_W);
  pose.velocity_W = taken(record.velocity_W);
  pose.surface_W = taken(record.surface_W);
  pose.normal_W = taken(record.normal_W);
  pose.force_W = taken(record.force_W);
  pose.tick = record.tick;
  pose.time_ns = record.time_ns;
  pose.window_version = record.window_version;
  pose.at_surface = record.at_surface != 0;
  pose.faults = record.faults;
  pose.leaps = record.leaps;
  const bool is_place = isSane(pose.position_W) && isSane(pose.velocity_W) && isSane(pose.surface_W) &&
                        isSane(pose.normal_W) && isSane(pose.force_W);
  if (is_place) latest_ = pose;
}

}  // namespace palpate
