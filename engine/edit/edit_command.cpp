// SPDX-License-Identifier: Apache-2.0
#include "engine/edit/edit_command.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/error.hpp"
#include "base/units.hpp"

namespace palpate {
namespace {

[[noreturn]] void refuseEdit(const EditCommand& command, const std::string& reason, const std::string& remedy) {
  throw Error(Error::Code::kBadInput, fmt::format("edit '{}'", editName(command.kind)), reason, remedy);
}

double mm(double length_m) {
  return length_m * kMillimetresPerMetre;
}

double diagonalLength(const Vec3i& size, const Lattice& lattice) {
  return (size - Vec3i::Ones()).cast<double>().cwiseProduct(lattice.spacing_m).norm();
}

void checkPlace(const EditCommand& command, const Vec3& p_W, const Vec3i& size, const Lattice& lattice) {
  if (!p_W.allFinite()) refuseEdit(command, "its place is not a number", "give a place in metres");
  const Vec3 p_L = lattice.toIndex(p_W);
  const Vec3 nearest_L = p_L.cwiseMax(0).cwiseMin((size - Vec3i::Ones()).cast<double>());
  const double away_m = (p_L - nearest_L).cwiseProduct(lattice.spacing_m).norm();
  if (away_m <= diagonalLength(size, lattice)) return;
  refuseEdit(command,
             fmt::format("its place ({:g}, {:g}, {:g}) mm is {:g} mm away from the volume", mm(p_W.x()), mm(p_W.y()),
                         mm(p_W.z()), mm(away_m)),
             "give a place in or near the volume, in the world's frame");
}

void checkBrush(const EditCommand& command, const Vec3i& size, const Lattice& lattice) {
  const double r_m = command.radius_m;
  if (!std::isfinite(r_m) || r_m <= 0)
    refuseEdit(command, fmt::format("its radius of {:g} mm is not positive", mm(r_m)), "give a radius above 0");
  const double most_m = diagonalLength(size, lattice);
  if (r_m > most_m) {
    refuseEdit(command, fmt::format("its radius of {:g} mm is larger than the volume", mm(r_m)),
               fmt::format("give at most {:g} mm", mm(most_m)));
  }
  if (!(command.falloff >= 0 && command.falloff <= 1))
    refuseEdit(command, fmt::format("its falloff of {:g} is not between 0 and 1", command.falloff),
               "give 0 for a hard edge");
}

void checkDensity(const EditCommand& command, double density, const char* what) {
  if (std::isfinite(density) && std::abs(density) <= kLargestDensity) return;
  refuseEdit(command, fmt::format("its {} of {:g} is no density", what, density),
             fmt::format("give a number between {:g} and {:g}", -kLargestDensity, kLargestDensity));
}

void checkMaterial(const EditCommand& command, const MaterialRate& material) {
  checkDensity(command, material.low_density, "soft density");
  checkDensity(command, material.high_density, "hard density");
  if (!(material.low_density < material.high_density)) {
    refuseEdit(command,
               fmt::format("its material goes from density {:g} to {:g}", material.low_density, material.high_density),
               "give the softer density first");
  }
  if (!(material.drop >= 0 && material.drop <= 1))
    refuseEdit(command, fmt::format("its drop of {:g} is not between 0 and 1", material.drop),
               "give 1 for full resistance");
}

// A little below the 2^30 bytes of a journal's longest record (docs/journal.md), which also holds the stamp's lattice.
constexpr long long kMostStampVoxels = (1023LL << 20U) / sizeof(float);

void checkStamp(const EditCommand& command) {
  if (!command.stamp) refuseEdit(command, "it has no stamp", "give a mesh");
  const Stamp& stamp = *command.stamp;
  checkLattice(stamp.lattice, "stamp");
  const std::string size = fmt::format("{} x {} x {} voxels", stamp.size.x(), stamp.size.y(), stamp.size.z());
  // Checked first, so that the product of the sizes cannot overflow.
  if (stamp.size.minCoeff() < 2 || stamp.size.maxCoeff() > 1024)
    refuseEdit(command, "its stamp has " + size, "give 2 to 1024 voxels along an axis");
  const long long voxels = stamp.size.cast<long long>().prod();
  if (voxels > kMostStampVoxels) {
    refuseEdit(command,
               fmt::format("its stamp of {} voxels needs more than the {} MiB that one may take", voxels,
                           kMostStampVoxels * sizeof(float) >> 20U),
               "make its voxels larger");
  }
  if (stamp.distance_m.size() != static_cast<std::size_t>(voxels)) {
    refuseEdit(command, fmt::format("its stamp has {} distances for {}", stamp.distance_m.size(), size),
               "give a distance for each voxel");
  }
  if (!std::all_of(stamp.distance_m.begin(), stamp.distance_m.end(), [](float d) { return std::isfinite(d); }))
    refuseEdit(command, "its stamp has distances that are no numbers", "make it again");
  const Mat3& rotation = command.R_WS;
  if (!rotation.allFinite() || !(rotation.transpose() * rotation).isIdentity(1e-6))
    refuseEdit(command, "its stamp is turned by a matrix that is no rotation", "give an orthonormal matrix");
}

Vec3 reflected(const Vec3& p_W, const Vec3& plane_W, const Vec3& unit_W) {
  return p_W - 2 * unit_W.dot(p_W - plane_W) * unit_W;
}

}  // namespace

const char* editName(EditKind kind) noexcept {
  static constexpr std::array kNames = {"add",       "remove",       "paint",  "flatten", "cut",
                                        "stamp add", "stamp remove", "smooth", "inflate", "deflate"};
  static_assert(kNames.size() == kEditKinds);
  return kNames[static_cast<std::size_t>(kind)];
}

bool isStamp(EditKind kind) noexcept {
  return kind == EditKind::kStampAdd || kind == EditKind::kStampRemove;
}
bool hasValue(EditKind kind) noexcept {
  return kind == EditKind::kPaint;
}
bool hasPlane(EditKind kind) noexcept {
  return kind == EditKind::kFlatten || kind == EditKind::kCut;
}
bool isBrush(EditKind kind) noexcept {
  return !isStamp(kind) && kind != EditKind::kCut;
}
bool makesSurface(EditKind kind) noexcept {
  return kind == EditKind::kAdd || kind == EditKind::kRemove;
}

EditCommand mirrored(const EditCommand& command, const Vec3& plane_W, const Vec3& normal_W) {
  if (!normal_W.allFinite() || !plane_W.allFinite() || normal_W.norm() == 0)
    refuseEdit(command, "its mirror plane has no direction", "give a normal that is not zero");
  const Vec3 unit_W = normal_W.normalized();
  const Mat3 reflection = Mat3::Identity() - 2 * unit_W * unit_W.transpose();
  EditCommand twin = command;
  twin.from_W = reflected(command.from_W, plane_W, unit_W);
  twin.to_W = reflected(command.to_W, plane_W, unit_W);
  twin.plane_W = reflected(command.plane_W, plane_W, unit_W);
  twin.normal_W = reflection * command.normal_W;
  twin.R_WS = reflection * command.R_WS;
  return twin;
}

void checkEdit(const EditCommand& command, const Vec3i& size, const Lattice& lattice) {
  if (!(command.strength > 0 && command.strength <= 1)) {
    refuseEdit(command, fmt::format("its strength of {:g} is not above 0 and at most 1", command.strength),
               "give 1 for the full effect");
  }
  if (command.kind != EditKind::kCut) checkPlace(command, command.from_W, size, lattice);
  if (isBrush(command.kind)) {
    checkPlace(command, command.to_W, size, lattice);
    checkBrush(command, size, lattice);
  }
  if (hasPlane(command.kind)) {
    checkPlace(command, command.plane_W, size, lattice);
    if (!command.normal_W.allFinite() || !(command.normal_W.norm() > 0) || !std::isfinite(command.normal_W.norm()))
      refuseEdit(command, "its plane has no direction", "give a normal that is not zero");
  }
  if (isStamp(command.kind)) checkStamp(command);
  if (hasValue(command.kind)) checkDensity(command, command.value, "value");
  if (command.object) checkDensity(command, *command.object, "object density");
  if (command.material) checkMaterial(command, *command.material);
}

}  // namespace palpate
