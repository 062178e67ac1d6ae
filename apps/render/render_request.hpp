// SPDX-License-Identifier: Apache-2.0
// apps/render/render_request.hpp: everything that a user can ask of `palpate render`, with its defaults. SI units. The
// flags, units and limits are in render_options.cpp.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/units.hpp"
#include "base/vec.hpp"
#include "engine/draw/draw_style.hpp"

namespace palpate {

// Where the camera is as seen from its target. World: LPS, the patient's frame.
struct ViewAngles {
  double azimuth_rad = 0;    // 0: in front (-y), growing towards the patient's left (+x)
  double elevation_rad = 0;  // above the horizontal plane, towards the head (+z)
};

// Densities that a slice shows black and white. Black may be the higher one.
struct SliceRange {
  double black = 0, white = 1;  // [density]
};

// A plane as a user gives it. World: LPS.
struct AskedPlane {
  std::string text = {};          // as it was given, for messages
  Vec3 normal_W = Vec3::UnitZ();  // unit
  // Along the normal: from the world's origin [m]; or as a share of the volume's extent, 0 where the volume begins and
  // 1 where it ends.
  double place = 0;
  bool is_share = false;
};

struct RenderRequest {
  std::string in;     // as loadVolume takes it
  std::string out;    // picture, ends in .png; with frames each has a number (picture_files.hpp)
  std::string depth;  // depth image, ends in .pfm; empty: none
  std::string json;   // file that the caller writes the result to; empty: none

  std::optional<double> isovalue;      // empty: as `palpate touch` chooses it [density]
  std::string filter;                  // chain that the field goes through first; empty: none
  std::string gpu;                     // part of the device's name; empty: the best one
  std::uint64_t gpu_memory_bytes = 0;  // limit for densities; 0: the device's memory

  int width = 1280, height = 720;           // [pixel]
  int frames = 1;                           // of a whole turn around the vertical axis
  ViewAngles view;                          // of the first frame
  std::optional<Vec3> target_W;             // empty: the middle of what is drawn [m]
  std::optional<double> distance_m;         // from the target to the camera; empty: so that all is in the picture [m]
  double fov_rad = 30 / kDegreesPerRadian;  // vertical angle of view, before `zoom`
  double zoom = 1;                          // how many times larger things appear than without it [-]

  std::vector<AskedPlane> clips, slices;
  std::optional<SliceRange> slice_range;  // empty: slice_range.hpp
  std::optional<double> second;           // isovalue of a second surface, drawn translucent [density]
  double second_opacity = DrawStyle{}.other_opacity;
  bool occlusion = DrawStyle{}.occlusion;
  bool normals = false;
};

}  // namespace palpate
