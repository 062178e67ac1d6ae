// SPDX-License-Identifier: Apache-2.0
// servo/devices/look_alikes.hpp: what currents are at the handle of an arm that may be another one than it is said to
// be.
//
// Several arms have the same USB numbers and the same reports, so nothing that an arm says tells which one it is. Each
// of them would know its pose from the same counts, since each has been calibrated in its own home position. Motors
// whose plugs or leads are swapped make other forces of the same currents. So the most that currents can be is that
// over all of these arms, and over all orders and directions of the motors.
// Units: A, N, rad. Any thread, const after construction; no heap in most_N(); no errors. Cost: some 0.1 us an arm.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "base/vec.hpp"
#include "servo/devices/arm_kinematics.hpp"

namespace palpate {

class LookAlikes {
 public:
  struct Arm {
    ArmKinematics arm;
    std::array<int, 3> home_counts;
    std::array<double, 3> lowest_rad, highest_rad;  // that its joints can be turned to
  };
  // The first one is the arm that it is said to be.
  explicit LookAlikes(std::vector<Arm> arms) : arms_(std::move(arms)) {}

  // Whether the joints of the first arm can be where these counts say.
  [[nodiscard]] bool isPossible(const ArmCounts& counts) const noexcept;
  // The most that these currents can be at the handle [N], with counts of the first arm. Infinite where one of the arms
  // is stretched out.
  [[nodiscard]] double most_N(const Vec3& currents_A, const ArmCounts& counts) const noexcept;
  // The same without arms whose joints cannot be where these counts say: it is none of them.
  [[nodiscard]] double mostOfPossible_N(const Vec3& currents_A, const ArmCounts& counts) const noexcept;

 private:
  [[nodiscard]] double most_N(const Vec3& currents_A, const ArmCounts& counts, bool only_possible) const noexcept;

  std::vector<Arm> arms_;
};

}  // namespace palpate
