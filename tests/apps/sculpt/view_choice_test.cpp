// SPDX-License-Identifier: Apache-2.0
// What is chosen against points of the volume: which of them the planes leave.
#include "apps/sculpt/view_choice.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/refusal.hpp"

namespace palpate {
namespace view_choice_test {

const Vec3i kSize(41, 21, 11);  // 40, 20 and 10 mm between the outermost voxels
const Lattice kLattice = [] {
  Lattice lattice;
  lattice.origin_W = {0.1, 0.2, 0.3};
  lattice.spacing_m = Vec3::Constant(1e-3);
  return lattice;
}();

bool isKept(const DrawStyle& style, const Vec3& p_W) {
  return std::all_of(style.clips.begin(), style.clips.end(),
                     [&](const ViewPlane& plane) { return plane.normal_W.dot(p_W) >= plane.offset_m; });
}

TEST(ViewChoice, ShowsAllAtFirst) {
  const DrawStyle style = styleOf(ViewChoice{}, kLattice, kSize);
  EXPECT_TRUE(style.clips.empty());
  EXPECT_TRUE(style.slices.empty());
  EXPECT_FALSE(style.other_isovalue.has_value());
  EXPECT_EQ(style, DrawStyle{});  // what is drawn by default has one owner
}

// At a quarter along each axis, both ways: of two points a tenth of a voxel before and behind it one is kept.
TEST(ViewChoice, CutsAtAShareOfTheExtent) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const bool keeps_low : {false, true}) {
      ViewChoice choice;
      choice.cuts[axis] = {.on = true, .share = 0.25, .keeps_low = keeps_low};
      const DrawStyle style = styleOf(choice, kLattice, kSize);
      ASSERT_EQ(style.clips.size(), 1U);
      Vec3 at_L = (kSize - Vec3i::Ones()).cast<double>() / 2;
      const int i = static_cast<int>(axis);
      at_L[i] = 0.25 * (kSize[i] - 1) - 0.1;
      EXPECT_EQ(isKept(style, kLattice.toWorld(at_L)), keeps_low) << axis;
      at_L[i] += 0.2;
      EXPECT_EQ(isKept(style, kLattice.toWorld(at_L)), !keeps_low) << axis;
    }
  }
}

TEST(ViewChoice, SlicesAtAShareOfTheExtent) {
  ViewChoice choice;
  choice.slices[0] = {.on = true, .share = 0.75};
  choice.slices[2] = {.on = true, .share = 0};
  choice.slice_range = {.black = -7, .white = 9};
  const DrawStyle style = styleOf(choice, kLattice, kSize);
  ASSERT_EQ(style.slices.size(), 2U);
  EXPECT_NEAR(style.slices[0].offset_m / style.slices[0].normal_W.x(), 0.1 + 30e-3, 1e-12);
  EXPECT_NEAR(style.slices[1].offset_m / style.slices[1].normal_W.z(), 0.3, 1e-12);
  EXPECT_EQ(style.slice_black, -7);
  EXPECT_EQ(style.slice_white, 9);
}

TEST(ViewChoice, HasASecondSurface) {
  ViewChoice choice;
  choice.second_isovalue = -300;
  choice.second_opacity = 0.2;
  choice.occlusion = true;
  const DrawStyle style = styleOf(choice, kLattice, kSize);
  EXPECT_EQ(style.other_isovalue, -300);
  EXPECT_EQ(style.other_opacity, 0.2);
  EXPECT_TRUE(style.occlusion);
}

TEST(ViewChoice, RefusesToLeaveNothing) {
  ViewChoice choice;
  choice.cuts[1] = {.on = true, .share = 1};
  EXPECT_THAT(refusalOf([&] { static_cast<void>(styleOf(choice, kLattice, kSize)); }),
              testing::AllOf(testing::HasSubstr("nothing is left"), testing::HasSubstr("flip it")));
  choice.cuts[1].share = 0.99;
  EXPECT_NO_THROW(static_cast<void>(styleOf(choice, kLattice, kSize)));
}

}  // namespace view_choice_test
}  // namespace palpate
