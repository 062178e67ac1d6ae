// SPDX-License-Identifier: Apache-2.0
// Which bricks an edit is said to reach, against every voxel that it changes; and what constant bricks become.
#include "engine/edit/edit_reach.hpp"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "engine/reference/edited_density.hpp"

namespace palpate {
namespace edit_reach_test {

const Vec3i kSize(45, 38, 29);

Lattice lattice() {
  Lattice lattice;
  lattice.spacing_m = {0.7e-3, 0.9e-3, 1.3e-3};
  return lattice;
}
const BrickGrid kGrid{kSize, lattice().spacing_m};
const BrushProfile kProfile = brushProfile(30, -100, 200, lattice().spacing_m);
// The ramp is lost in the isovalue's rounding: as floats, background, isovalue and object are one.
const BrushProfile kFlat = brushProfile(1e6, 1e6 - 1e-3, 1e6 + 1e-3, lattice().spacing_m);

// All kinds that are a formula of the voxel alone.
std::vector<EditKind> kindsOfOneVoxel() {
  std::vector<EditKind> kinds;
  for (unsigned n = 0; n < kEditKinds; ++n) {
    const auto kind = static_cast<EditKind>(n);
    if (!isStamp(kind) && !EDIT_READS_NEIGHBOURS(layoutKind(kind))) kinds.push_back(kind);
  }
  return kinds;
}

EditCommand drawn(std::mt19937& random) {
  const auto between = [&](double low, double high) {
    return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
  };
  const auto place = [&] { return lattice().toWorld({between(-3, 48), between(-3, 41), between(-3, 32)}); };
  EditCommand command;
  static const std::vector<EditKind> kKinds = kindsOfOneVoxel();
  command.kind = kKinds[random() % kKinds.size()];
  command.from_W = place();
  command.to_W = random() % 2 == 0 ? place() : command.from_W;
  command.radius_m = between(0.3e-3, 20e-3);
  command.falloff = random() % 2 == 0 ? 0 : between(0, 1);
  command.strength = random() % 2 == 0 ? 1 : between(0.1, 1);
  command.value = 77;
  command.plane_W = place();
  command.normal_W = {between(-1, 1), between(-1, 1), between(-1, 1)};
  return command;
}

// Every voxel of every brick is edited by the twin: a voxel that changes lies in a reached brick and in the box; a
// brick that is called uniform holds that value everywhere.
TEST(EditReach, HoldsEveryVoxelThatChanges) {
  std::mt19937 random(5);
  const layout::EditScale scale = editScale(lattice().spacing_m);
  int uniform = 0;
  for (int n = 0; n < 90; ++n) {
    const EditCommand command = drawn(random);
    const BrushProfile& profile = n % 3 == 0 ? kFlat : kProfile;
    const layout::EditCommand c = lowerEdits(std::span(&command, 1), kSize, lattice(), profile).commands.front();
    const auto before = static_cast<float>(profile.isovalue + (random() % 2 == 0 ? 120 : -90));
    const auto bricks = reachedBricks(c, kGrid);
    EXPECT_TRUE(std::is_sorted(bricks.begin(), bricks.end()));
    const VoxelBox box = reachedBox(c, kGrid);
    for (std::uint32_t b = 0; b < static_cast<std::uint32_t>(kGrid.counts().prod()); ++b) {
      const bool reached = std::binary_search(bricks.begin(), bricks.end(), b);
      const std::optional<float> all = uniformResult(c, kGrid, b, before);
      uniform += all && *all != before ? 1 : 0;
      const Vec3i first = kGrid.brick(b) * kBrickSize;
      const Vec3i last = (first.array() + kBrickSize - 1).min(kSize.array() - 1);
      for (int k = first.z(); k <= last.z(); ++k) {
        for (int j = first.y(); j <= last.y(); ++j) {
          for (int i = first.x(); i <= last.x(); ++i) {
            const float after = reference::editedDensity(c, scale, {}, {i, j, k}, before, {});
            ASSERT_EQ(after, all.value_or(after)) << n << ' ' << editName(command.kind);
            if (after == before) continue;
            ASSERT_TRUE(reached) << n << ' ' << editName(command.kind) << " brick " << b;
            ASSERT_TRUE((Vec3i(i, j, k).array() >= box.first.array()).all());
            ASSERT_TRUE((Vec3i(i, j, k).array() <= box.last.array()).all());
          }
        }
      }
    }
  }
  EXPECT_GT(uniform, 100);  // there is something to test
}

// A small brush in a large volume: a handful of bricks, whatever the volume's size.
TEST(EditReach, FollowsTheBrush) {
  EditCommand command;
  command.radius_m = 8e-3;
  Lattice large;
  large.spacing_m = Vec3::Constant(1e-3);
  command.from_W = command.to_W = Vec3(0.5, 0.5, 0.5);
  const Vec3i size = Vec3i::Constant(2048);
  const BrickGrid grid{size, large.spacing_m};
  const auto lowered = lowerEdits(std::span(&command, 1), size, large, brushProfile(0, -1, 1, large.spacing_m));
  EXPECT_LE(reachedBricks(lowered.commands.front(), grid).size(), 64U);  // 20 voxels across: four bricks at most
  // From corner to corner: bricks near the line, not those of the box around it.
  command.from_W = Vec3::Zero();
  command.to_W = Vec3::Constant(2.047);
  const auto stroke = lowerEdits(std::span(&command, 1), size, large, brushProfile(0, -1, 1, large.spacing_m));
  const auto bricks = reachedBricks(stroke.commands.front(), grid);
  // A tube of radius (10 + half a brick's diagonal, 7) voxels and length 3546: 3.2e6 voxels, 6.3e3 bricks.
  EXPECT_LE(bricks.size(), 7000U);
  EXPECT_GE(bricks.size(), 2000U);
}

}  // namespace edit_reach_test
}  // namespace palpate
