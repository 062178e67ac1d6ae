// SPDX-License-Identifier: Apache-2.0
// reset() leaves nothing: whatever an algorithm has been through, its next run is that of a new one, to the bit. The
// next run's windows have the numbers, the storage and the edit of the first, but other samples.
#include <bit>

#include <gtest/gtest.h>

#include "support/algorithm_setups.hpp"

namespace palpate {
namespace reset_test {

constexpr int kSide = 28;  // samples
const Vec3 kOut(0.6, 0.48, 0.64);
const Vec3 kAside(0.8, -0.36, -0.48);

AnalyticVolume ballOf(double voxel_m, double radius_voxels) {
  AnalyticVolume volume;
  volume.lattice.spacing_m = Vec3::Constant(voxel_m);
  volume.size = Vec3i::Constant(kSide);
  volume.density = ball(Vec3::Constant(14 * voxel_m), radius_voxels * voxel_m);
  return volume;
}

// One algorithm under one window. Places are in voxels from the ball's centre, outwards and aside.
class Player {
 public:
  Player(Algorithm& algorithm, HeldWindow& held, double voxel_m)
      : algorithm_(algorithm), held_(held), voxel_m_(voxel_m) {}

  void reset(double out) {
    last_W_ = place(out, 0);
    algorithm_.reset(last_W_);
  }
  void at(double out, double aside = 0) {
    const Vec3 hip_W = place(out, aside);
    TickOutput felt;
    algorithm_.tick({hip_W, (hip_W - last_W_) * 1000, &held_.window}, felt);
    last_W_ = hip_W;
    for (const Vec3& v : {felt.vhip_W, felt.normal_W, felt.force_W, felt.surface_W}) {
      for (const double x : v) bits.push_back(std::bit_cast<std::uint64_t>(x));
    }
    bits.push_back(std::bit_cast<std::uint64_t>(felt.depth_m));
    for (const std::uint64_t word : {std::uint64_t{felt.in_contact}, std::uint64_t{felt.at_surface},
                                     std::uint64_t{felt.faults}, static_cast<std::uint64_t>(felt.plane_age_ticks)})
      bits.push_back(word);
    touched = touched || felt.in_contact;
  }
  void stay(int ticks, double out) {
    for (int i = 0; i < ticks; ++i) at(out);
  }
  void publish(const AnalyticVolume& volume, std::uint64_t version, std::uint64_t edit, int first = 0,
               int count = kSide) {
    volume.hold(held_, Vec3i::Constant(first), Vec3i::Constant(count), version);
    held_.window.edit_version = edit;
  }

  std::vector<std::uint64_t> bits;
  bool touched = false;

 private:
  [[nodiscard]] Vec3 place(double out, double aside) const {
    return voxel_m_ * (Vec3::Constant(14) + out * kOut + aside * kAside);
  }

  Algorithm& algorithm_;
  HeldWindow& held_;
  double voxel_m_;
  Vec3 last_W_ = Vec3::Zero();
};

// Presses a ball of 8 voxels; how it ends is what the next run must not know.
enum class End { kPressed, kEdited, kLost, kUnseen, kInside, kFree };
constexpr End kEnds[] = {End::kPressed, End::kEdited, End::kLost, End::kUnseen, End::kInside, End::kFree};

void play(Player& player, End end) {
  const AnalyticVolume before = ballOf(1e-3, 8), larger = ballOf(1e-3, 10), full = ballOf(1e-3, 1000);
  const bool changes = end == End::kEdited || end == End::kLost || end == End::kUnseen;
  player.publish(before, changes ? 2 : 1, 0);
  player.reset(end == End::kInside ? 5 : 9);
  if (end == End::kInside) return player.stay(3, 5);
  player.stay(2, 9);
  if (end == End::kFree) return;
  player.stay(4, 7);
  if (end == End::kEdited) player.publish(larger, 1, 1);
  if (end == End::kLost) player.publish(full, 1, 1);
  if (end == End::kUnseen) player.publish(before, 1, 0, 0, 8);
  player.stay(3, 7);
}

// The same ball of larger voxels: pressed from outside or from inside on, with a slide.
void playOn(Player& player, bool from_inside) {
  player.publish(ballOf(1.5e-3, 8), 1, 0);
  player.reset(from_inside ? 6 : 9);
  player.stay(3, from_inside ? 6 : 9);
  for (int i = 0; i < 12; ++i) player.at(from_inside ? 6 : 7, 0.1 * i);
  player.stay(2, 9);
  player.stay(8, 7);
}

TEST(Reset, LeavesNothing) {
  for (const AlgorithmEntry& entry : algorithms()) {
    const AnalyticVolume volume = ballOf(1.5e-3, 8);
    const auto make = [&] { return makeFor(entry.name, {}, volume, 4e-3); };
    HeldWindow held;
    held.samples.reserve(std::size_t{kSide} * kSide * kSide);  // so that all windows lie in one place
    for (const bool from_inside : {false, true}) {
      const auto fresh = make();
      Player wanted(*fresh, held, 1.5e-3);
      playOn(wanted, from_inside);
      EXPECT_TRUE(wanted.touched) << entry.name;
      for (const End end : kEnds) {
        const auto used = make();
        Player first(*used, held, 1e-3);
        play(first, end);
        Player second(*used, held, 1.5e-3);
        playOn(second, from_inside);
        EXPECT_EQ(second.bits, wanted.bits) << entry.name << ", end " << static_cast<int>(end) << ", " << from_inside;
      }
    }
  }
}

}  // namespace reset_test
}  // namespace palpate
