// SPDX-License-Identifier: Apache-2.0
#include "engine/bricks/brick_grid.hpp"

#include "engine/field/volume.hpp"

namespace palpate {

VoxelBox intersection(const VoxelBox& a, const VoxelBox& b) {
  return {a.first.cwiseMax(b.first), a.last.cwiseMin(b.last)};
}

VoxelBox hull(const VoxelBox& a, const VoxelBox& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  return {a.first.cwiseMin(b.first), a.last.cwiseMax(b.last)};
}

Vec3i BrickGrid::counts() const noexcept {
  return (size + Vec3i::Constant(kBrickSize - 1)) / kBrickSize;
}
std::size_t BrickGrid::brickCount() const noexcept {
  const Vec3i n = counts();
  return static_cast<std::size_t>(n.x()) * static_cast<std::size_t>(n.y()) * static_cast<std::size_t>(n.z());
}
std::uint32_t BrickGrid::index(const Vec3i& brick) const noexcept {
  const Vec3i n = counts();
  return (static_cast<std::uint32_t>(brick.z()) * static_cast<std::uint32_t>(n.y()) +
          static_cast<std::uint32_t>(brick.y())) *
             static_cast<std::uint32_t>(n.x()) +
         static_cast<std::uint32_t>(brick.x());
}
Vec3i BrickGrid::brick(std::uint32_t index) const noexcept {
  const Vec3i n = counts();
  const auto i = static_cast<std::int64_t>(index);
  return {static_cast<int>(i % n.x()), static_cast<int>(i / n.x() % n.y()), static_cast<int>(i / n.x() / n.y())};
}
bool BrickGrid::holds(const Vec3i& brick) const noexcept {
  return brick.minCoeff() >= 0 && (brick.array() < counts().array()).all();
}
VoxelBox BrickGrid::box(std::uint32_t index) const noexcept {
  const Vec3i first = brick(index) * kBrickSize;
  return {first, (first + Vec3i::Constant(kBrickSize - 1)).cwiseMin(size - Vec3i::Ones())};
}
VoxelBox BrickGrid::widened(const VoxelBox& box, const Vec3i& by) const noexcept {
  return {(box.first - by).cwiseMax(Vec3i::Zero()), (box.last + by).cwiseMin(size - Vec3i::Ones())};
}

}  // namespace palpate
