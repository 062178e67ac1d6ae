// SPDX-License-Identifier: Apache-2.0
// engine/edit/edit_command.hpp: one change of a volume, as a tool asks for it. It is a brush along a straight piece of
// the tool's path, a plane, or a stamp (a closed mesh). What each kind does to the densities: docs/edits.md.
//
// Frame W: world [m]. A brush is a capsule: all points within radius_m of the segment from from_W to to_W. Capsules
// that share an end leave no gap, however fast the tool moved.
// Thread: any.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/lattice.hpp"
#include "base/vec.hpp"
#include "engine/field/mesh_distance.hpp"

namespace palpate {

// Journals hold the numbers of kinds, so a new one goes to the end. Kernels have the same numbers
// (shaders/edit.layout.h).
enum class EditKind {
  kAdd,          // fills the capsule
  kRemove,       // clears the capsule
  kPaint,        // moves densities towards `value`
  kFlatten,      // turns the surface inside the capsule into a plane
  kCut,          // clears the half space that the plane's normal points into
  kStampAdd,     // fills a mesh
  kStampRemove,  // clears a mesh
  kSmooth,       // smooths the densities in the capsule
  kInflate,      // moves the surface outwards
  kDeflate       // moves it inwards
};
inline constexpr unsigned kEditKinds = static_cast<unsigned>(EditKind::kDeflate) + 1;
[[nodiscard]] const char* editName(EditKind kind) noexcept;

// Makes removal slower in denser material. At or below low_density a brush acts with its full strength, at or above
// high_density with (1 - drop) of it. In between the share is linear in the density.
struct MaterialRate {
  double low_density = 0;   // [density]
  double high_density = 1;  // [density]
  double drop = 1;          // [0, 1]
};

inline constexpr double kLargestDensity = 1e30;  // largest magnitude that a command may name [density]

using Stamp = MeshDistance;  // in the stamp's own frame S

struct EditCommand {
  EditKind kind = EditKind::kRemove;
  Vec3 from_W = Vec3::Zero();            // start of the segment; for a stamp, where its origin goes [m]
  Vec3 to_W = Vec3::Zero();              // end of the segment; equal to from_W for a single dab [m]
  double radius_m = 0;                   // of brushes [m]
  double strength = 1;                   // share of the full effect, (0, 1] [-]; force and duration are part of it
  double falloff = 0;                    // share of the radius over which the strength fades to zero, [0, 1] [-]
  double value = 0;                      // paint: target [density]
  Vec3 plane_W = Vec3::Zero();           // flatten, cut: a point of the plane [m]
  Vec3 normal_W = Vec3::UnitZ();         // flatten, cut: points away from what stays; any length but zero
  std::optional<double> object;          // add, flatten: density of what is added; empty: BrushProfile::object
  std::optional<MaterialRate> material;  // remove
  std::shared_ptr<const Stamp> stamp;    // stamps
  Mat3 R_WS = Mat3::Identity();          // stamp frame S to world, a rotation or reflection
};

// The same edit on the other side of a plane. Pass an edit and its mirror image to one Editor::apply().
[[nodiscard]] EditCommand mirrored(const EditCommand& command, const Vec3& plane_W, const Vec3& normal_W);

// Which members a kind of command uses: radius_m (brush), value, plane_W and normal_W (plane), stamp (stamp).
[[nodiscard]] bool isBrush(EditKind kind) noexcept;
[[nodiscard]] bool makesSurface(EditKind kind) noexcept;  // a brush with a surface of its own: add and remove
[[nodiscard]] bool hasValue(EditKind kind) noexcept;
[[nodiscard]] bool hasPlane(EditKind kind) noexcept;
[[nodiscard]] bool isStamp(EditKind kind) noexcept;

// Checks a command for a volume of `size` voxels on `lattice`. Throws Error(kBadInput) that says what is wrong and what
// is allowed, for: a radius that is not positive or exceeds the volume's diagonal; a strength outside (0, 1] or a
// falloff outside [0, 1]; a place farther than a diagonal from the volume; a plane with a zero normal; a density beyond
// kLargestDensity; a stamp whose size, lattice or distances are invalid; NaN or infinity.
void checkEdit(const EditCommand& command, const Vec3i& size, const Lattice& lattice);

}  // namespace palpate
