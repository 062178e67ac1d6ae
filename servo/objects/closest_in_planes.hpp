// SPDX-License-Identifier: Apache-2.0
// servo/objects/closest_in_planes.hpp: where a tool is held that presses against several virtual planes at once.
//
// The point nearest to the HIP on the outer sides of all planes: min |x - HIP|^2 with N_i . (x - p_i) >= 0, at most
// three of the planes being active (Zilles and Salisbury 1995). To be defined for every input, the constraints are
// springs, 1 / kSoftness times as stiff as the one that pulls x to the HIP:
//   min |x - HIP|^2 + sum_i min(0, N_i . (x - p_i))^2 / kSoftness.
// This has one solution always. It is the proximal map of a convex function, so |x(a) - x(b)| <= |a - b| and the same
// for x - HIP: with planes at rest a force K (x - HIP) never changes by more than K times what the HIP moves, at
// whatever angle the planes meet. Where they leave no room, it is the point that violates them least (in squares).
// What it costs: an active plane is violated by kSoftness times its share of the push, 0.1 nm for a depth of 1 m.
// Frame W: world [m]. Any thread. No heap, lock, system call or throw. Cost: one plane 3 ns, three some 50 ns, six at
// most 41 small systems.
#pragma once

#include <span>

#include "base/vec.hpp"
#include "servo/contact/contact_plane.hpp"

namespace palpate {

inline constexpr double kPlaneSoftness = 1e-10;  // [-]

// Normals are unit. Three planes at most are active in the solution; beyond three planes that push at once (only
// possible where they leave no room or meet in one point) it is that of the three which fit the others best.
[[nodiscard]] Vec3 closestInPlanes(std::span<const ContactPlane> planes, const Vec3& hip_W) noexcept;

}  // namespace palpate
