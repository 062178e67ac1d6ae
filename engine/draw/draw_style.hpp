// SPDX-License-Identifier: Apache-2.0
// engine/draw/draw_style.hpp: what a picture of the isosurface shows. What is not asked for costs nothing.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/vec.hpp"

namespace palpate {

// The points p_W with normal_W . p_W = offset_m. World frame.
struct ViewPlane {
  Vec3 normal_W = Vec3::UnitZ();  // any length but 0
  double offset_m = 0;            // [m], times the normal's length
  bool operator==(const ViewPlane&) const = default;
};

struct DrawStyle {
  bool occlusion = false;  // hollows are darker; it darkens and grains rough surfaces, so it is off unless asked for
  bool normals = false;    // colours are normals in the camera's frame (x right, y up, z to the eye)
  std::vector<ViewPlane> clips;  // only what lies in front of all of them (where the normal points) is drawn; at most 6
  std::vector<ViewPlane> slices;         // planes on which the density is shown; at most 3
  double slice_black = 0;                // density shown black [density]
  double slice_white = 1;                // and white
  std::optional<double> other_isovalue;  // of a second isosurface, drawn translucent in front of the first [density]
  double other_opacity = 0.35;           // of it, 0 to 1
  bool operator==(const DrawStyle&) const = default;
};

// In which order a picture appears.
enum class DrawOrder {
  kWhole,        // tile by tile
  kCoarseFirst,  // every fourth pixel (of a slow device every eighth), every second, all: while a camera moves
};

// How far the picture is that is kept up to date.
struct PictureState {
  std::uint64_t pieces = 0;   // of work that are done, since the start
  bool showable = false;      // all pixels are of the present camera, coarse ones perhaps
  bool fine = false;          // and all of them fine
  bool whole = false;         // and of the volume as it is
  std::uint64_t version = 0;  // of the volume: every edit up to it is seen
};

// Throws Error(kBadInput) for more planes than can be drawn, a normal of length 0, or figures that are not finite.
void checkStyle(const DrawStyle& style);

}  // namespace palpate
