// SPDX-License-Identifier: Apache-2.0
#include "engine/edit/lower_edit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include <fmt/format.h>

#include "base/error.hpp"

namespace palpate {
namespace {

// How far one command inflates a surface at most, as a share of the smallest spacing. It is below 1/sqrt(3), so the
// upwind scheme makes no new extrema.
constexpr double kInflateStepVoxels = 0.5;

// Clamps to the largest float, for steep ramps between densities near it.
float f(double value) {
  constexpr double kLargest = std::numeric_limits<float>::max();
  return static_cast<float>(std::clamp(value, -kLargest, kLargest));
}

// Index at which the distances of each stamp begin.
using StampPlaces = std::unordered_map<const Stamp*, std::size_t>;

class Lowering {
 public:
  Lowering(const EditCommand& command, const Lattice& lattice, const BrushProfile& profile)
      : command_(command), lattice_(lattice), profile_(profile) {
    out_.kind = layoutKind(command.kind);
    origin_voxel_ = lattice.toIndex(command.kind == EditKind::kCut ? command.plane_W : command.from_W).array().round();
    out_.origin_x = static_cast<int>(origin_voxel_.x());
    out_.origin_y = static_cast<int>(origin_voxel_.y());
    out_.origin_z = static_cast<int>(origin_voxel_.z());
    out_.strength = f(command.strength);
    out_.reach = f(profile.band_m);
    surface();
  }

  layout::EditCommand lower(std::vector<float>& stamps, StampPlaces& places) {
    if (isBrush(command_.kind)) brush();
    if (hasPlane(command_.kind)) plane();
    if (isStamp(command_.kind)) stamp(stamps, places);
    if (hasValue(command_.kind)) out_.value = f(command_.value);
    if (command_.kind == EditKind::kInflate || command_.kind == EditKind::kDeflate)
      out_.value = f(kInflateStepVoxels * lattice_.smallestSpacing());
    if (command_.material) material(*command_.material);
    return out_;
  }

 private:
  // Position along the lattice's axes from the origin voxel [m].
  [[nodiscard]] Vec3 local(const Vec3& p_W) const {
    return (lattice_.toIndex(p_W) - origin_voxel_).cwiseProduct(lattice_.spacing_m);
  }

  // The ramp of the surface that this command leaves.
  void surface() {
    const double object = command_.object.value_or(profile_.object);
    out_.isovalue = f(profile_.isovalue);
    out_.background = f(profile_.background);
    out_.object = f(object);
    out_.slope = f(command_.object ? slopeTowards(profile_, object) : profile_.slope_per_m);
  }

  void brush() {
    const Vec3 a = local(command_.from_W);
    const Vec3 ab = local(command_.to_W) - a;
    out_.a_x = f(a.x());
    out_.a_y = f(a.y());
    out_.a_z = f(a.z());
    if (ab.norm() > 1e-4 * lattice_.smallestSpacing()) {
      out_.ab_x = f(ab.x());
      out_.ab_y = f(ab.y());
      out_.ab_z = f(ab.z());
      out_.inv_ab2 = f(1 / ab.squaredNorm());
    }
    out_.radius = f(command_.radius_m);
    // A command that makes a surface carries its ramp beyond the radius, unless it fades out before. Every other
    // command ends at the radius, with an edge of at least a voxel.
    const double fade_m = command_.falloff * command_.radius_m;
    const double edge_m = makesSurface(command_.kind) ? 0 : lattice_.spacing_m.maxCoeff();
    const double width_m = std::max(fade_m, edge_m);
    out_.inv_fade = width_m > 0 ? f(1 / width_m) : 0;
    out_.reach = f(width_m > 0 ? command_.radius_m : command_.radius_m + profile_.band_m);
  }

  void plane() {
    const Vec3 n_L = (lattice_.R_WL.transpose() * command_.normal_W).normalized();
    out_.n_x = f(n_L.x());
    out_.n_y = f(n_L.y());
    out_.n_z = f(n_L.z());
    out_.n_d = f(n_L.dot(local(command_.plane_W)));
  }

  void stamp(std::vector<float>& stamps, StampPlaces& places) {
    const Stamp& stamp = *command_.stamp;
    // Stamp voxel = scaled p + t, with p along the lattice's axes from the origin voxel.
    const Mat3 to_stamp = stamp.lattice.R_WL.transpose() * command_.R_WS.transpose() * lattice_.R_WL;
    const Mat3 scaled = stamp.lattice.spacing_m.cwiseInverse().asDiagonal() * to_stamp;
    const Vec3 own = command_.R_WS.transpose() * (lattice_.toWorld(origin_voxel_) - command_.from_W);
    const Vec3 t = stamp.lattice.toIndex(own);
    out_.m_xx = f(scaled(0, 0)), out_.m_xy = f(scaled(0, 1)), out_.m_xz = f(scaled(0, 2)), out_.m_xt = f(t.x());
    out_.m_yx = f(scaled(1, 0)), out_.m_yy = f(scaled(1, 1)), out_.m_yz = f(scaled(1, 2)), out_.m_yt = f(t.y());
    out_.m_zx = f(scaled(2, 0)), out_.m_zy = f(scaled(2, 1)), out_.m_zz = f(scaled(2, 2)), out_.m_zt = f(t.z());
    const auto [place, is_new] = places.try_emplace(&stamp, stamps.size());
    if (is_new) stamps.insert(stamps.end(), stamp.distance_m.begin(), stamp.distance_m.end());
    out_.stamp_first = static_cast<layout::uint>(place->second);
    out_.stamp_x = static_cast<layout::uint>(stamp.size.x());
    out_.stamp_y = static_cast<layout::uint>(stamp.size.y());
    out_.stamp_z = static_cast<layout::uint>(stamp.size.z());
  }

  void material(const MaterialRate& material) {
    out_.material_low = f(material.low_density);
    out_.material_inv_range = f(1 / (material.high_density - material.low_density));
    out_.material_drop = f(material.drop);
  }

  const EditCommand& command_;
  const Lattice& lattice_;
  const BrushProfile& profile_;
  Vec3 origin_voxel_;
  layout::EditCommand out_{};
};

}  // namespace

layout::uint layoutKind(EditKind kind) noexcept {
  constexpr auto kNumber = [](EditKind k) { return static_cast<layout::uint>(k); };
  static_assert(kNumber(EditKind::kAdd) == EDIT_ADD && kNumber(EditKind::kRemove) == EDIT_REMOVE &&
                kNumber(EditKind::kPaint) == EDIT_PAINT && kNumber(EditKind::kFlatten) == EDIT_FLATTEN &&
                kNumber(EditKind::kCut) == EDIT_CUT && kNumber(EditKind::kStampAdd) == EDIT_STAMP_ADD &&
                kNumber(EditKind::kStampRemove) == EDIT_STAMP_REMOVE && kNumber(EditKind::kSmooth) == EDIT_SMOOTH &&
                kNumber(EditKind::kInflate) == EDIT_INFLATE && kNumber(EditKind::kDeflate) == EDIT_DEFLATE &&
                kEditKinds == EDIT_KINDS);
  return kNumber(kind);
}

LoweredEdits lowerEdits(std::span<const EditCommand> commands, const Vec3i& size, const Lattice& lattice,
                        const BrushProfile& profile) {
  if (commands.empty() || commands.size() > kMaxCommands) {
    throw Error(Error::Code::kBadInput, "edit", fmt::format("{} commands were given at once", commands.size()),
                fmt::format("give 1 to {}", kMaxCommands));
  }
  LoweredEdits lowered;
  for (const EditCommand& command : commands) {
    checkEdit(command, size, lattice);
    if (command.object && *command.object <= profile.isovalue) {
      throw Error(Error::Code::kBadInput, fmt::format("edit '{}'", editName(command.kind)),
                  fmt::format("its object density of {:g} is not above the isovalue", *command.object),
                  fmt::format("give more than {:g}", profile.isovalue));
    }
  }
  StampPlaces places;
  for (const EditCommand& command : commands)
    lowered.commands.push_back(Lowering(command, lattice, profile).lower(lowered.stamps, places));
  return lowered;
}

layout::EditScale editScale(const Vec3& spacing_m) {
  const double smallest = spacing_m.minCoeff();
  const auto blur = [=](double h) {  // the largest stable step of heat flow
    const double ratio = smallest / h;
    return f(ratio * ratio / 6);
  };
  const double x = spacing_m.x();
  const double y = spacing_m.y();
  const double z = spacing_m.z();
  return {f(x), f(y), f(z), blur(x), blur(y), blur(z), f(1 / x), f(1 / y), f(1 / z)};
}

}  // namespace palpate
