// SPDX-License-Identifier: Apache-2.0
// apps/render/fit_camera.hpp: cameras from which all that is drawn is in the picture. World: LPS [m]. Any thread. Cost:
// a look at every brick's bounds, and with the volume at the voxels of its six outer layers of bricks; for a fitting
// distance some operations for each point and frame: at 2048^3 at most some 50000 points.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "apps/render/render_request.hpp"
#include "base/camera.hpp"
#include "base/lattice.hpp"
#include "engine/bricks/brick_grid.hpp"
#include "shaders/brick_pool.layout.h"

namespace palpate {

// From the target to the camera, and upwards in the picture. Unit, at right angles; defined straight above and below
// too.
struct ViewAxes {
  Vec3 from_W = Vec3::Zero(), up_W = Vec3::Zero();
};
[[nodiscard]] ViewAxes axesOf(const ViewAngles& angles) noexcept;

// The view of a frame: a turn is divided evenly among the frames.
[[nodiscard]] ViewAngles frameView(const RenderRequest& request, int frame) noexcept;

// What is to be in the picture: points whose convex hull holds all of it.
struct SeenExtent {
  Vec3 middle_W = Vec3::Zero();  // of its box along the lattice's axes [m]
  std::vector<Vec3> points_W;    // [m]
};

// All that is above the isovalue, and its surface, to a brick: a brick that a clip plane cuts counts whole, and one
// that lies behind a plane does not count. With the volume and without clips the box around it
// is exact to a voxel. wholeExtent() where no brick is left. `bounds`: of each brick (BrickBoundsPass). The points
// are hulls of the layers of bricks along k.
[[nodiscard]] SeenExtent objectExtent(std::span<const layout::BrickBounds> bounds, const BrickGrid& grid,
                                      const Lattice& lattice, float isovalue, std::span<const ViewPlane> clips = {},
                                      const Volume* volume = nullptr);
// What the clip planes leave of the domain, from the centres of its first to those of its last voxels. They leave some
// (styleOf() has seen to that).
[[nodiscard]] SeenExtent wholeExtent(const BrickGrid& grid, const Lattice& lattice,
                                     std::span<const ViewPlane> clips = {});

// Where the camera looks: the target that was asked for, or the middle.
[[nodiscard]] Vec3 targetOf(const RenderRequest& request, const SeenExtent& extent);

// The least distance from the target at which every frame has all points within this share of the picture, of its half
// width and height, with a zoom of 1. `between`: called with every frame; may throw to cancel.
inline constexpr double kFilledShare = 0.95;
[[nodiscard]] double fittingDistance(const RenderRequest& request, const SeenExtent& extent,
                                     const std::function<void()>& between = {});

// The camera of a frame, at this distance from the target.
[[nodiscard]] Camera frameCamera(const RenderRequest& request, const Vec3& target_W, double distance_m, int frame);

}  // namespace palpate
