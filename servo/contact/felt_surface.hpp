// SPDX-License-Identifier: Apache-2.0
// servo/contact/felt_surface.hpp: the surface under the tool as contact effects see it: point, normal, curvature.
//
// A sampled surface is rough: noise, or the stairs of a mask. A normal that errs by s puts the surface point D s aside
// at a depth of D, and anything that differences samples there jumps with every voxel. So the effects ask this object,
// and none of them reads samples beside it. Three words:
// - unevenness: by how much the normals around a place differ from those of a smooth surface [rad], as measured here
//   and now (surface_patch.hpp);
// - lever: how far aside that unevenness puts the surface point at the depth of the press [voxel], the largest of the
//   last kForget voxels;
// - roughness: the length over which the surface is smoothed for that lever, as a share of the longest [-]. It follows
//   gradually, so that nothing jumps where a smooth place meets a rough one.
// - In each tick the patch under the tool is measured (surface_patch.hpp), at the place where the felt normal meets the
//   plane of the algorithm.
// - On a smooth surface the measure is taken as it is. On a rough one it is smoothed over the way of the tool: the
//   length is kSmoothed times what the lever has beyond kLeastLever, at most kLongest voxels. Meanwhile the normal goes
//   on turning by the curvature that was found so far, so on a curved surface it does not lag.
// - At rest the way grows by kRest voxels a second, so that an error is not felt for ever.
// - Fields over the surface, as textures, are read at a place that follows the surface point without jumps: at a sharp
//   edge that point leaps, and a texture's force with it.
// - What an edit turns is taken in evenly over EditEase::kTime_s, as the algorithm takes in the depth that it adds.
// Where another object holds the tool the surface is the contact's plane, and flat.
//
// Frame W: world [m]. Thread: the servo's; no heap, lock, system call or throw. Cost: that of a patch and its
// curvature, some 300 ns a tick in contact; nothing where no effect feels the surface and no object meets the volume.
// Errors: none; where there are no samples the plane is felt, with the curvature known before.
#pragma once

#include "servo/contact/contact_plane.hpp"
#include "servo/contact/edit_ease.hpp"
#include "servo/contact/shape_operator.hpp"
#include "servo/contact/surface_patch.hpp"
#include "servo/contact/window_cache.hpp"

namespace palpate {

struct FeltPoint {
  Vec3 p_W = Vec3::Zero();             // the surface point under the tool, as far as edits are taken in [m]
  Vec3 place_W = Vec3::Zero();         // where the tool is in fields over the surface: p_W, but it does not jump [m]
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
  static constexpr double kSmoothed = 6;       // length of smoothing, in levers [-]
  static constexpr double kLeastLever = 0.01;  // that sampling gives a smooth surface, too [voxel]
  static constexpr double kLongest = 6;        // [voxel]
  static constexpr double kRest = 10;          // [voxel/s]
  static constexpr double kForget = 8;         // way over which an uneven place is remembered [voxel]
  // How far the felt normal may be from the plane's: the tangent of 72 degrees. At a sharp edge the plane turns faster
  // than anything that is smoothed can follow [-].
  static constexpr double kMostApart = 3;
  // How far aside of the depth the surface point may be: the tangent of 45 degrees [-].
  static constexpr double kMostAside = 1;
  // How far the place at which fields are read goes in a tick, as a multiple of what the tool's own motion explains on
  // a surface of the curvature that was found [-]. Where the surface point jumps, at a sharp edge, the place follows.
  static constexpr double kMostAhead = 1.5;

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
  struct Form {
    Vec3 normal_W = Vec3::Zero();
    Mat3 S_W = Mat3::Zero();  // curvature, as of SurfacePatch [1/m]
  };
  struct Measure {  // of the patch under the tool; where it is not known, what was known before
    Form form;
    double depth_m = 0;   // of the HIP below the plane
    double offset_m = 0;  // of the mean surface in front of the plane
  };
  struct Way {                // of the tool in this tick
    double voxels = 0;        // and what counts as way at rest
    double aside_voxels = 0;  // the part along the plane
  };
  void begin(const Contact& contact) noexcept;
  void predict(const Vec3& way_W) noexcept;
  [[nodiscard]] Vec3 footOf(const Contact& contact) const noexcept;
  [[nodiscard]] Way wayOf(const WindowSampler& sampler, const Vec3& way_W, const ContactPlane& plane) const noexcept;
  [[nodiscard]] Measure measure(const WindowSampler& sampler, const Contact& contact, const Way& way) noexcept;
  void takeIn(const Measure& measured, const Way& way, const Vec3& plane_W) noexcept;
  void tell(const Contact& contact, bool begins) noexcept;

  double isovalue_;
  double rest_voxels_;  // a tick
  WindowCache window_;
  bool known_ = false;  // there was a tick in this contact
  std::uint64_t edit_version_ = 0;
  Vec3 last_hip_W_ = Vec3::Zero();
  Form form_;                      // as it is, smoothed
  EditLead<Vec3> normal_ahead_W_;  // by how much it is ahead of what is felt, after edits
  EditLead<Mat3> bend_ahead_W_;
  double depth_m_ = 0;      // smoothed
  double trust_ = 1;        // in the curvature, which is flat without [-]
  double lever_ = 0;        // [voxel]
  double slid_voxels_ = 0;  // along the surface in this contact
  double most_way_m_ = 0;   // of the place in this tick
  FeltPoint felt_;
};

}  // namespace palpate
