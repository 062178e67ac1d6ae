// SPDX-License-Identifier: Apache-2.0
// servo/algorithms/iso_field.hpp: a window with an isovalue: is a point in the object, and where does a line enter it?
//
// Density above tau is object, at or below it background (the paper, section 3.1). Beyond the volume is background. A
// place beyond the window is kUnknown; it is never taken for either side. Frame W: world [m]. Thread: the servo's.
// Cost: stated at each search, in fetches; every search has a stated maximum. Errors: none.
#pragma once

#include <optional>

#include "servo/window/window_sampler.hpp"

namespace palpate {

enum class Side : std::uint8_t { kOutside, kInside, kUnknown };

struct Probe {
  Vec3 p_W = Vec3::Zero();  // [m]
  double density = 0;       // -infinity beyond the volume
  Side side = Side::kUnknown;
};

// A face of the volume, or none. Where the volume ends inside the object, that face is the object's surface.
struct CutFace {
  int axis = -1;  // of the lattice; -1: none
  bool high = false;
  [[nodiscard]] bool any() const noexcept { return axis >= 0; }
};

// Where a line enters the object from outside.
struct Entry {
  Vec3 p_W = Vec3::Zero();          // on the surface [m]
  Vec3 direction_W = Vec3::Zero();  // unit, from outside to inside along the line [-]
  CutFace face;
};

class IsoField {
 public:
  // A way out is searched in steps of at most half the smallest voxel side. A line that would need more than this many
  // gets longer steps.
  static constexpr int kMaxSearchSteps = 256;
  // Regula falsi steps that bring an entry from half a voxel to about 1e-4 of one.
  static constexpr int kMaxRefineSteps = 6;
  // How far from a buried point a way out may end [voxel].
  static constexpr double kLongestWayOut = 32;
  // A search from a surface point begins this far in front of it, since rounding may have put it in the object [voxel
  // along the normal].
  static constexpr double kStandOff = 0.25;
  [[nodiscard]] static Vec3 inFrontOf(const WindowSampler& sampler, const Vec3& surface_W,
                                      const Vec3& normal_W) noexcept {
    return surface_W + normal_W * (kStandOff * sampler.voxelAlong(normal_W));
  }

  IsoField() = default;
  IsoField(const SampleWindow& window, double isovalue) noexcept : sampler_(window), isovalue_(isovalue) {}

  [[nodiscard]] const WindowSampler& sampler() const noexcept { return sampler_; }
  [[nodiscard]] double isovalue() const noexcept { return isovalue_; }
  [[nodiscard]] double voxel() const noexcept { return sampler_.smallestSpacing(); }  // the smallest side [m]
  // A way cut to one voxel, measured along it.
  [[nodiscard]] Vec3 cutToVoxel(const Vec3& way_W) const noexcept {
    const double squared = sampler_.squaredVoxels(way_W);
    return squared <= 1 ? way_W : Vec3(way_W / std::sqrt(squared));
  }

  // One fetch.
  [[nodiscard]] Probe probe(const Vec3& p_W) const noexcept {
    const Fetch f = sampler_.at(p_W);
    const Side known = f.density > isovalue_ ? Side::kInside : Side::kOutside;
    return {p_W, f.density, f.place == Place::kBeyondWindow ? Side::kUnknown : known};
  }

  // The first place between `from` and `to` where the line goes from outside to inside; both ends may be outside. The
  // search is exact: it goes cell by cell, and within a cell the density along the line is a cubic. So no wall is
  // jumped, however thin it is and however short the line. One exception: if the line begins inside, an air gap of less
  // than a third of the line's part in a cell may be missed. Fetches: none for a line within one cell that holds no
  // object. Otherwise three for each cell that the line passes (at most three cells a voxel of length), and
  // kMaxRefineSteps + 1 at the entry.
  [[nodiscard]] std::optional<Entry> firstEntry(const Probe& from, const Probe& to) const noexcept;

  // From a point inside, the first place on the line to `to_W` where it leaves the object. It is given as an entry, as
  // seen from outside. At most kMaxSearchSteps + kMaxRefineSteps + 1 fetches.
  [[nodiscard]] std::optional<Entry> firstExit(const Probe& inside, const Vec3& to_W) const noexcept;

  // From a point inside, the nearest way out. Seven directions are tried: down the gradient, and both ways along the
  // lattice's axes. None from a point outside, and none if all is object for kLongestWayOut. At most seven firstExit()
  // of that length and a fetch.
  [[nodiscard]] std::optional<Entry> nearestExit(const Probe& inside) const noexcept;

  // Whether a HIP behind a plane is outside the object, with no object between the two. An edit may have removed the
  // object there and left the plane on the rim of the hollow. No fetch for a HIP in the object, else one and
  // firstEntry().
  [[nodiscard]] bool inAirBehind(const Vec3& on_plane_W, const Vec3& normal_W, const Probe& hip) const noexcept;

  // The point in the box of the window's samples that is nearest to a world position [m].
  [[nodiscard]] Vec3 clampToBox(const Vec3& p_W) const noexcept;

 private:
  [[nodiscard]] int searchSteps(const Vec3& way_W) const noexcept;
  [[nodiscard]] std::optional<Entry> entryInCell(const Probe& before, const Probe& after) const noexcept;
  [[nodiscard]] Entry refined(Probe outside, Probe inside) const noexcept;
  [[nodiscard]] CutFace clipToBox(Probe& outside, const Probe& inside) const noexcept;

  WindowSampler sampler_;
  double isovalue_ = 0;
};

}  // namespace palpate
