// SPDX-License-Identifier: Apache-2.0
// What edits are refused for, with what words; mirrors; the brush profile.
#include "engine/edit/edit_command.hpp"

#include <cmath>
#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "engine/edit/lower_edit.hpp"

namespace palpate {
namespace edit_command_test {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
const Vec3i kSize(40, 30, 20);

Lattice lattice() {
  Lattice lattice;
  lattice.spacing_m = {1e-3, 1e-3, 2e-3};
  return lattice;
}

EditCommand good(EditKind kind) {
  EditCommand command;
  command.kind = kind;
  command.from_W = command.to_W = command.plane_W = {0.01, 0.01, 0.01};
  command.radius_m = 3e-3;
  if (isStamp(kind)) {
    auto stamp = std::make_shared<Stamp>();
    stamp->size = {2, 2, 2};
    stamp->distance_m.assign(8, -1.0F);
    command.stamp = stamp;
  }
  return command;
}

struct Refusal {
  const char* name;
  EditKind kind;
  std::function<void(EditCommand&)> spoil;
  const char* words;
};

class Refused : public testing::TestWithParam<Refusal> {};

TEST_P(Refused, SaysWhatIsWrong) {
  EditCommand command = good(GetParam().kind);
  EXPECT_NO_THROW(checkEdit(command, kSize, lattice()));
  GetParam().spoil(command);
  try {
    checkEdit(command, kSize, lattice());
    FAIL() << "it was accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::Code::kBadInput);
    EXPECT_NE(std::string(error.what()).find(GetParam().words), std::string::npos) << error.what();
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Edits, Refused,
    testing::Values(
        Refusal{"radius_zero", EditKind::kRemove, [](auto& c) { c.radius_m = 0; }, "radius of 0 mm is not positive"},
        Refusal{"radius_negative", EditKind::kAdd, [](auto& c) { c.radius_m = -1e-3; }, "radius of -1 mm"},
        Refusal{"radius_nan", EditKind::kSmooth, [](auto& c) { c.radius_m = kNan; }, "is not positive"},
        Refusal{"radius_infinite", EditKind::kPaint, [](auto& c) { c.radius_m = kInfinity; }, "is not positive"},
        Refusal{"radius_huge", EditKind::kRemove, [](auto& c) { c.radius_m = 1; }, "larger than the volume"},
        Refusal{"strength_zero", EditKind::kRemove, [](auto& c) { c.strength = 0; }, "strength of 0"},
        Refusal{"strength_negative", EditKind::kCut, [](auto& c) { c.strength = -0.5; }, "strength of -0.5"},
        Refusal{"strength_huge", EditKind::kInflate, [](auto& c) { c.strength = 1e9; }, "at most 1"},
        Refusal{"strength_nan", EditKind::kFlatten, [](auto& c) { c.strength = kNan; }, "strength of nan"},
        Refusal{"falloff_nan", EditKind::kAdd, [](auto& c) { c.falloff = kNan; }, "falloff of nan"},
        Refusal{"falloff_large", EditKind::kAdd, [](auto& c) { c.falloff = 1.5; }, "falloff of 1.5"},
        Refusal{"place_nan", EditKind::kRemove, [](auto& c) { c.from_W.y() = kNan; }, "place is not a number"},
        Refusal{"end_infinite", EditKind::kRemove, [](auto& c) { c.to_W.x() = kInfinity; }, "place is not a number"},
        Refusal{"far_outside", EditKind::kRemove, [](auto& c) { c.to_W.x() = 5; }, "away from the volume"},
        Refusal{"stamp_far", EditKind::kStampAdd, [](auto& c) { c.from_W.z() = -9; }, "away from the volume"},
        Refusal{"plane_far", EditKind::kCut, [](auto& c) { c.plane_W.x() = 7; }, "away from the volume"},
        Refusal{"normal_zero", EditKind::kCut, [](auto& c) { c.normal_W.setZero(); }, "no direction"},
        Refusal{"normal_nan", EditKind::kFlatten, [](auto& c) { c.normal_W.x() = kNan; }, "no direction"},
        Refusal{"value_nan", EditKind::kPaint, [](auto& c) { c.value = kNan; }, "is no density"},
        Refusal{"value_huge", EditKind::kPaint, [](auto& c) { c.value = 1e35; }, "is no density"},
        Refusal{"object_nan", EditKind::kAdd, [](auto& c) { c.object = kNan; }, "is no density"},
        Refusal{"material_order", EditKind::kRemove,
                [](auto& c) {
                  c.material = MaterialRate{5, 5, 1};
                },
                "softer density first"},
        Refusal{"material_drop", EditKind::kRemove,
                [](auto& c) {
                  c.material = MaterialRate{0, 5, 2};
                },
                "drop of 2"},
        Refusal{"stamp_none", EditKind::kStampAdd, [](auto& c) { c.stamp.reset(); }, "no stamp"},
        Refusal{"stamp_beyond_a_record", EditKind::kStampAdd,
                [](auto& c) {
                  auto stamp = std::make_shared<Stamp>(*c.stamp);
                  stamp->size = {1024, 1024, 256};  // 2^30 bytes, were its distances there
                  c.stamp = stamp;
                },
                "more than the 1023 MiB"},
        // The product of these, were it asked for, is beyond 64 bits.
        Refusal{"stamp_absurd", EditKind::kStampAdd,
                [](auto& c) {
                  auto stamp = std::make_shared<Stamp>(*c.stamp);
                  stamp->size = Vec3i::Constant(std::numeric_limits<int>::max());
                  c.stamp = stamp;
                },
                "2147483647 voxels; give 2 to 1024 voxels along an axis"},
        Refusal{"stamp_short", EditKind::kStampRemove,
                [](auto& c) {
                  auto stamp = std::make_shared<Stamp>(*c.stamp);
                  stamp->distance_m.pop_back();
                  c.stamp = stamp;
                },
                "7 distances"},
        Refusal{"stamp_nan", EditKind::kStampAdd,
                [](auto& c) {
                  auto stamp = std::make_shared<Stamp>(*c.stamp);
                  stamp->distance_m[3] = std::numeric_limits<float>::quiet_NaN();
                  c.stamp = stamp;
                },
                "no numbers"},
        Refusal{"stamp_sheared", EditKind::kStampAdd, [](auto& c) { c.R_WS(0, 1) = 0.5; }, "no rotation"}),
    [](const auto& refusal) { return std::string(refusal.param.name); });

TEST(LowerEdits, RefusesNoneTooManyAndAnObjectThatIsNone) {
  const BrushProfile profile = brushProfile(10, 0, 30, lattice().spacing_m);
  EXPECT_THROW((void)lowerEdits({}, kSize, lattice(), profile), Error);
  const std::vector<EditCommand> many(kMaxCommands + 1, good(EditKind::kAdd));
  EXPECT_THROW((void)lowerEdits(many, kSize, lattice(), profile), Error);
  EditCommand command = good(EditKind::kAdd);
  command.object = 10;
  EXPECT_THROW((void)lowerEdits(std::span(&command, 1), kSize, lattice(), profile), Error);
}

TEST(Mirrored, TwiceIsTheSame) {
  EditCommand command = good(EditKind::kFlatten);
  command.to_W = {0.02, 0.005, 0.03};
  command.normal_W = {1, 2, 3};
  const Vec3 plane(0.004, 0, 0);
  const Vec3 normal(2, 0.5, 0);
  const EditCommand twin = mirrored(command, plane, normal);
  EXPECT_GT((twin.to_W - command.to_W).norm(), 1e-3);
  // The middle between both lies in the plane.
  EXPECT_NEAR(((twin.to_W + command.to_W) / 2 - plane).dot(normal), 0, 1e-15);
  const EditCommand again = mirrored(twin, plane, normal);
  EXPECT_LT((again.to_W - command.to_W).norm(), 1e-15);
  EXPECT_LT((again.normal_W - command.normal_W).norm(), 1e-14);
  EXPECT_THROW((void)mirrored(command, plane, Vec3::Zero()), Error);
}

// The flatter side decides: 20 above the isovalue against 10 below, over two of the largest voxels.
TEST(BrushProfile, IsLinearOverTheBandOnBothSides) {
  const BrushProfile profile = brushProfile(10, 0, 30, {1e-3, 1e-3, 2e-3});
  EXPECT_DOUBLE_EQ(profile.band_m, 4e-3);
  EXPECT_DOUBLE_EQ(profile.slope_per_m, 10 / 4e-3);
}

TEST(BrushProfile, TakesTheObjectsMeanAndTheLowestDensity) {
  std::vector<float> values(1000, -50.0F);
  for (std::size_t i = 0; i < 250; ++i) values[i] = i < 125 ? 100.0F : 200.0F;
  const Volume volume = Volume::fromDense({10, 10, 10}, lattice(), values, {});
  const BrushProfile profile = brushProfile(volume, 0);
  EXPECT_EQ(profile.background, -50);
  EXPECT_NEAR(profile.object, 150, 0.5);  // bins of 250/256
  EXPECT_THROW((void)brushProfile(volume, 500), Error);
}

// At full strength a command moves the surface by half of the shortest voxel edge.
TEST(LowerEdits, InflatesByHalfAVoxel) {
  Lattice long_voxels = lattice();
  long_voxels.spacing_m = {2e-3, 0.75e-3, 3e-3};
  for (const EditKind kind : {EditKind::kInflate, EditKind::kDeflate}) {
    const EditCommand command = good(kind);
    const LoweredEdits lowered =
        lowerEdits(std::span(&command, 1), kSize, long_voxels, brushProfile(0, -1, 1, long_voxels.spacing_m));
    EXPECT_EQ(lowered.commands[0].value, 0.375e-3F);
  }
}

// A mirrored stamp is the same one, and large ones fill what a device can bind.
TEST(LowerEdits, HandsAStampOverOnce) {
  EditCommand first = good(EditKind::kStampAdd);
  EditCommand other = good(EditKind::kStampRemove);
  const std::vector<EditCommand> commands = {first, other, mirrored(first, first.from_W, Vec3::UnitX()), first};
  const LoweredEdits lowered = lowerEdits(commands, kSize, lattice(), brushProfile(0, -1, 1, lattice().spacing_m));
  EXPECT_EQ(lowered.stamps.size(), 16U);
  ASSERT_EQ(lowered.commands.size(), 4U);
  EXPECT_EQ(lowered.commands[0].stamp_first, 0U);
  EXPECT_EQ(lowered.commands[1].stamp_first, 8U);
  EXPECT_EQ(lowered.commands[2].stamp_first, 0U);
  EXPECT_EQ(lowered.commands[3].stamp_first, 0U);
}

}  // namespace edit_command_test
}  // namespace palpate
