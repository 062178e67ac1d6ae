// SPDX-License-Identifier: Apache-2.0
// servo/contact/felt_surface.hpp: the surface under the tool as contact effects see it: point, normal, curvature.
//
// A sampled surface is rough: noise, or the stairs of a mask. A normal that errs by s puts the surface point D s aside
// at a depth of D, and anything that differences samples there jumps with every voxel. So the effects ask this object,
// and none of them reads samples beside it.
// - In each tick the patch under the tool is measured (surface_patch.hpp), at the place where the felt normal meets the
//   plane of the algorithm.
// - On a smooth surface the measure is taken as it is. On an uneven one it is smoothed over the way of the tool: the
//   length is kSmoothed times what the lever D s of the unevenness s has beyond kSmooth, at most kLongest voxels.
//   Meanwhile the normal goes on turning by the curvature that was found so far, so on a curved surface it does not
//   lag.
// - At rest the way grows by kRest voxels a second, so that an error is not felt for ever.
// - What an edit turns is taken in evenly over EditEase::kTime_s, as the algorithm takes in the depth that it adds.
// Where another object holds the tool the surface is the contact's plane, and flat.
//
// Frame W: world [m]. Thread: the servo's; no heap, lock, system call or throw. Cost: that of a patch and its
// curvature, some 300 ns a tick in contact; nothing in a scene without effects. Errors: none; where there are no
// samples the plane is felt, with the curvature known before.
#pragma once

#include "servo/contact/contact_plane.hpp"
#include "servo/contact/shape_operator.hpp"
#include "servo/contact/surface_patch.hpp"
#include "servo/contact/window_cache.hpp"

namespace palpate {

struct FeltPoint {
  Vec3 p_W = Vec3::Zero();             // the surface point under the tool, as far as edits are taken in [m]
  Vec3 now_W = Vec3::Zero();           // the same on the volume as it is: the place to read samples at [m]
  Vec3 normal_W = Vec3::Zero();        // unit, out of the object [-]
  double depth_m = 0;                  // of the HIP below p_W, along the normal [m]
  ShapeOperator shape{Vec3::UnitX()};  // at p_W
  double roughness = 0;                // 0: smooth; 1: so uneven that the longest smoothing applies [-]
  bool edited = false;                 // an edit came in this tick
  std::array<Vec3, 3> patch_W = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};  // SurfacePatch::ways() [m]
  const SampleWindow* window = nullptr;  // null: nothing of the volume is felt. To be read by FeltField alone
};

class FeltSurface {
 public:
  static constexpr double kSmoothed = 6;   // length of smoothing, in levers [-]
  static constexpr double kSmooth = 0.01;  // lever that sampling gives a smooth surface, too [voxel]
  static constexpr double kLongest = 6;    // [voxel]
  static constexpr double kRest = 10;      // [voxel/s]
  static constexpr double kForget = 8;     // way over which an uneven place is remembered [voxel]
  static constexpr double kSteepest =
      1;  // largest move of the surface point along the plane, as a share of the depth [-]

  FeltSurface(double isovalue, double rate_hz) noexcept;

  struct Contact {
    Vec3 hip_W = Vec3::Zero();             // [m]
    ContactPlane plane;                    // as it is shown
    double eased_m = 0;                    // how far the volume's surface lies in front of it, along its normal [m]
    bool begins = false;                   // first tick of a contact
    bool on_volume = true;                 // the volume's isosurface alone holds the tool
    double sharpness = 1;                  // how many times over errors of the surface count: in a groove [-]
    const SampleWindow* window = nullptr;  // never null, may be unusable
  };
  // Once per tick in contact.
  [[nodiscard]] const FeltPoint& feel(const Contact& contact) noexcept;

  void release() noexcept;  // the contact has ended: forgets it

 private:
  struct Form {  // what is smoothed
    Vec3 normal_W = Vec3::Zero();
    Mat3 S_W = Mat3::Zero();
  };
  void begin(const Contact& contact) noexcept;
  void predict(const Vec3& way_W) noexcept;
  void measure(const Contact& contact, const Vec3& way_W) noexcept;
  void tell(const Contact& contact) noexcept;

  double isovalue_;
  double rest_voxels_;  // a tick
  double ease_ticks_;
  WindowCache window_;
  bool known_ = false;  // there was a tick in this contact
  std::uint64_t edit_version_ = 0;
  Vec3 last_hip_W_ = Vec3::Zero();
  Form form_;               // as it is, smoothed
  Form ahead_;              // by how much it is ahead of what is felt, after edits
  double ahead_ticks_ = 0;  // in which that is gone
  double depth_m_ = 0;      // smoothed
  double trust_ = 1;        // in the curvature, which is flat without [-]
  double lever_ = 0;        // of the unevenness [voxel]
  double slid_voxels_ = 0;  // along the surface in this contact
  FeltPoint felt_;
};

}  // namespace palpate
