// SPDX-License-Identifier: Apache-2.0
#include "engine/draw/draw_push.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/error.hpp"

namespace palpate {
namespace {

float asFloat(double value) {
  return static_cast<float>(value);
}

// A point of the lattice [voxel] is origin + R * (spacing . point) in the world.
layout::DrawPlane planeOf(const Lattice& lattice, const ViewPlane& plane) {
  const Vec3 unit_W = plane.normal_W.normalized();
  const double offset_m = plane.offset_m / plane.normal_W.norm();
  const Vec3 n = (lattice.R_WL.transpose() * unit_W).cwiseProduct(lattice.spacing_m);
  return {asFloat(n.x()), asFloat(n.y()), asFloat(n.z()), asFloat(unit_W.dot(lattice.origin_W) - offset_m)};
}

void checkPlanes(const std::vector<ViewPlane>& planes, const char* what, std::size_t most) {
  if (planes.size() > most)
    refuse(what, fmt::format("there are {}", planes.size()), fmt::format("give at most {}", most));
  for (const ViewPlane& plane : planes) {
    const double length = plane.normal_W.norm();
    if (std::isfinite(length) && length > 0 && std::isfinite(plane.offset_m)) continue;
    refuse(what, "a plane's normal is zero or not finite", "give a direction and a place");
  }
}

// Beyond this, an eye given as floats [voxel] is off by more than a sixteenth of a voxel.
constexpr double kFarthestEye_voxel = 1e6;

void checkCamera(const Camera& camera, const Lattice& lattice, const Vec3& size) {
  const bool known = camera.position_W.allFinite() && camera.forward_W.allFinite() && camera.right_W.allFinite() &&
                     camera.up_W.allFinite() && camera.vertical_fov_rad > 0 && camera.vertical_fov_rad < M_PI;
  if (!known)
    refuse("camera", "its place, axes or angle of view are not finite",
           "give a place, a target and an angle below 180 degrees");
  const Vec3 eye = lattice.toIndex(camera.position_W);
  const double away = (eye - eye.cwiseMax(Vec3::Zero()).cwiseMin(size)).cwiseAbs().maxCoeff();
  if (away <= kFarthestEye_voxel) return;
  refuse("camera", fmt::format("it is {:.3g} voxels away from the volume", away),
         fmt::format("take it nearer than {:g} voxels; a narrow angle of view shows as much", kFarthestEye_voxel));
}

}  // namespace

void checkStyle(const DrawStyle& style) {
  checkPlanes(style.clips, "clipping planes", DRAW_MOST_CLIPS);
  checkPlanes(style.slices, "slice planes", DRAW_MOST_SLICES);
  if (!std::isfinite(style.slice_black) || !std::isfinite(style.slice_white) || style.slice_black == style.slice_white)
    refuse("densities of slices", "black and white are equal or not finite", "give two densities");
  if (style.other_isovalue && !std::isfinite(*style.other_isovalue))
    refuse("second isovalue", "it is not finite", "give a density");
  if (!(style.other_opacity >= 0 && style.other_opacity <= 1))
    refuse("opacity", fmt::format("{:g} is not from 0 to 1", style.other_opacity), "give a share");
}

layout::PictureRays pictureRays(const Lattice& lattice, const Camera& camera) {
  const auto toLattice = [&](const Vec3& direction_W) -> Vec3 { return lattice.R_WL.transpose() * direction_W; };
  const double pixel = camera.pixelSize(1);
  const Vec3 right = toLattice(camera.right_W) * pixel;
  const Vec3 down = toLattice(-camera.up_W) * pixel;
  const Vec3 corner = toLattice(camera.forward_W) - right * (camera.width / 2.0) - down * (camera.height / 2.0);
  layout::PictureRays rays{};
  const auto set = [](float& x, float& y, float& z, const Vec3& v) {
    x = asFloat(v.x());
    y = asFloat(v.y());
    z = asFloat(v.z());
  };
  set(rays.spacing_x, rays.spacing_y, rays.spacing_z, lattice.spacing_m);
  set(rays.eye_x, rays.eye_y, rays.eye_z, lattice.toIndex(camera.position_W));
  set(rays.corner_x, rays.corner_y, rays.corner_z, corner);
  set(rays.right_x, rays.right_y, rays.right_z, right);
  set(rays.down_x, rays.down_y, rays.down_z, down);
  return rays;
}

layout::DrawPush drawPush(const layout::PoolDomain& domain, const Lattice& lattice, const Camera& camera,
                          double isovalue) {
  const bool fits = std::min(camera.width, camera.height) >= 1 &&
                    std::max(camera.width, camera.height) <= PICTURE_MOST_SIDE &&
                    std::int64_t{camera.width} * camera.height <= PICTURE_MOST_PIXELS;
  if (!fits) {
    refuse(
        "picture", fmt::format("{} x {} pixels cannot be drawn", camera.width, camera.height),
        fmt::format("ask for 1 to {} along each side, and at most {} in all", PICTURE_MOST_SIDE, PICTURE_MOST_PIXELS));
  }
  checkCamera(camera, lattice, Vec3(domain.size_x, domain.size_y, domain.size_z));
  layout::DrawPush push{};
  push.domain = domain;
  push.size = static_cast<layout::uint>(camera.width) | static_cast<layout::uint>(camera.height) << 16U;
  push.isovalue = asFloat(isovalue);
  push.rays = pictureRays(lattice, camera);
  return push;
}

layout::DrawExtras drawExtras(const Lattice& lattice, const DrawStyle& style) {
  layout::DrawExtras extras{};
  for (std::size_t i = 0; i < style.clips.size(); ++i) extras.clips[i] = planeOf(lattice, style.clips[i]);
  for (std::size_t i = 0; i < style.slices.size(); ++i) extras.slices[i] = planeOf(lattice, style.slices[i]);
  extras.slice_black = asFloat(style.slice_black);
  extras.slice_white = asFloat(style.slice_white);
  extras.other_isovalue = asFloat(style.other_isovalue.value_or(0));
  extras.other_opacity = asFloat(style.other_opacity);
  return extras;
}

}  // namespace palpate
