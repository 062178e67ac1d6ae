// SPDX-License-Identifier: Apache-2.0
// servo/objects/closest_in_planes.hpp: the VHIP of a tool that presses against several virtual planes at once.
//
// It is the point x nearest to the HIP on the outer sides of all planes: min |x - HIP|^2 with N_i . (x - p_i) >= 0,
// with at most three active planes (Zilles and Salisbury 1995). To have a solution for every input, the constraints are
// springs, 1 / kPlaneSoftness times as stiff as the one that pulls x to the HIP:
//   min |x - HIP|^2 + sum_i min(0, N_i . (x - p_i))^2 / kPlaneSoftness.
// This always has one solution. It is the proximal map of a convex function, so |x(a) - x(b)| <= |a - b|, and the same
// holds for x - HIP. With planes at rest, a force K (x - HIP) thus never changes by more than K times the HIP's motion,
// at whatever angle the planes meet. Planes that leave no room are violated as little as possible (in squares).
// The softness has a price: an active plane is violated by kPlaneSoftness times its share of the push, 0.1 nm for a
// depth of 1 m.
// Frame W: world [m]. Any thread. No heap, lock, system call or throw. Cost: one plane 3 ns, three some 50 ns, six at
// most 41 small systems.
#pragma once

#include <span>

#include "base/vec.hpp"
#include "servo/contact/contact_plane.hpp"

namespace palpate {

inline constexpr double kPlaneSoftness = 1e-10;  // [-]

// Normals are unit vectors. At most three planes are active in the solution. More can push at once only if they leave
// no room or meet in one point. Then the three planes are used whose solution fits the others best.
[[nodiscard]] Vec3 closestInPlanes(std::span<const ContactPlane> planes, const Vec3& hip_W) noexcept;

}  // namespace palpate
