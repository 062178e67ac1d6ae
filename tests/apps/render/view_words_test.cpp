// SPDX-License-Identifier: Apache-2.0
#include "apps/render/view_words.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "apps/render/fit_camera.hpp"

namespace palpate {
namespace view_words_test {

constexpr double kRounding = 1e-15;  // of sines and cosines of angles that are rounded themselves

struct Side {
  const char* name;
  Vec3 from_W, up_W;
};

// LPS: +x is the patient's left, +y the back, +z the head.
TEST(ViewWords, SidesAreThoseOfThePatient) {
  const Side sides[] = {{"front", -Vec3::UnitY(), Vec3::UnitZ()}, {"back", Vec3::UnitY(), Vec3::UnitZ()},
                        {"left", Vec3::UnitX(), Vec3::UnitZ()},   {"right", -Vec3::UnitX(), Vec3::UnitZ()},
                        {"top", Vec3::UnitZ(), -Vec3::UnitY()},   {"bottom", -Vec3::UnitZ(), -Vec3::UnitY()}};
  ASSERT_EQ(viewNames().size(), std::size(sides));
  for (const Side& side : sides) {
    const auto view = viewNamed(side.name);
    ASSERT_TRUE(view) << side.name;
    const ViewAxes axes = axesOf(*view);
    EXPECT_TRUE(axes.from_W.isApprox(side.from_W, kRounding)) << side.name << ": " << axes.from_W.transpose();
    EXPECT_TRUE(axes.up_W.isApprox(side.up_W, kRounding)) << side.name << ": " << axes.up_W.transpose();
  }
  EXPECT_FALSE(viewNamed("anterior"));
  EXPECT_FALSE(viewNamed(""));
}

TEST(ViewWords, AnglesAreInDegrees) {
  const auto view = viewAnglesOf("90,-30");
  ASSERT_TRUE(view);
  const ViewAxes axes = axesOf(*view);  // cos 30 to the left, sin 30 down
  EXPECT_TRUE(axes.from_W.isApprox(Vec3(std::sqrt(0.75), 0, -0.5), kRounding)) << axes.from_W.transpose();
  for (const char* good : {"-360,-90", "360,90", "0.5,1e1"}) EXPECT_TRUE(viewAnglesOf(good)) << good;
  for (const char* bad : {"", "90", "90,", ",30", "361,0", "-361,0", "0,91", "0,-91", "nan,0", "0,inf", "1,2,3", "a,b"})
    EXPECT_FALSE(viewAnglesOf(bad)) << bad;
}

void expectPlane(const char* text, const Vec3& normal_W, double place, bool is_share = false) {
  const auto plane = planeOf(text);
  ASSERT_TRUE(plane) << text;
  EXPECT_TRUE(plane->normal_W.isApprox(normal_W, kRounding)) << text << ": " << plane->normal_W.transpose();
  EXPECT_NEAR(plane->place, place, 1e-16) << text;
  EXPECT_EQ(plane->is_share, is_share) << text;
  EXPECT_EQ(plane->text, text);
}

// The normal points to the side that is kept.
TEST(ViewWords, PlanesHaveAPlaceAndASide) {
  expectPlane("x=12", Vec3::UnitX(), 0.012);
  expectPlane("-x=12", -Vec3::UnitX(), -0.012);
  expectPlane("y=-3.5", Vec3::UnitY(), -0.0035);
  expectPlane("-z=-1", -Vec3::UnitZ(), 0.001);
  expectPlane("0,3,-4@5", Vec3(0, 0.6, -0.8), 0.005);
  expectPlane("1e-200,0,0@0", Vec3::UnitX(), 0);  // the square of this length is 0 in a double
  for (const char* bad : {"", "x", "x=", "x12", "w=1", "--x=1", "+x=1", "x=1mm", "x=nan", "x=inf", "x=1.1e6", "0,0,0@1",
                          "1,0@1", "1,0,0@", "@1", "1,0,0@nan", "1,0,0@-1e7", "X=1"})
    EXPECT_FALSE(planeOf(bad)) << bad;
}

// Shares are counted along the normal, so that of a plane that looks back is counted from the other end.
TEST(ViewWords, PlanesMayLieAtAShareOfTheVolume) {
  expectPlane("x=25%", Vec3::UnitX(), 0.25, true);
  expectPlane("-x=25%", -Vec3::UnitX(), 0.75, true);
  expectPlane("z=0%", Vec3::UnitZ(), 0, true);
  expectPlane("-z=100%", -Vec3::UnitZ(), 0, true);
  expectPlane("0,3,-4@12.5%", Vec3(0, 0.6, -0.8), 0.125, true);
  for (const char* bad : {"x=%", "x=-1%", "x=100.1%", "x=nan%", "x=50%%", "x=50 %", "x%=50", "1,0,0@%", "1,0,0@101%"})
    EXPECT_FALSE(planeOf(bad)) << bad;
}

TEST(ViewWords, ABoxIsTwoCornersInMillimetres) {
  EXPECT_EQ(boxWords({{-0.09, -0.0, 0.5402}, {0.09, 0.125, 0.7847}}), "-90,0,540.2 to 90,125,784.7 mm");
}

TEST(ViewWords, SizesAreTwoWholeNumbers) {
  const auto size = pictureSizeOf("640x480");
  ASSERT_TRUE(size);
  EXPECT_EQ(size->width, 640);
  EXPECT_EQ(size->height, 480);
  for (const char* bad : {"", "640", "640x", "x480", "0x1", "1x0", "-1x1", "1.5x2", "640X480", "1x2x3", "9999999999x1"})
    EXPECT_FALSE(pictureSizeOf(bad)) << bad;
}

TEST(ViewWords, ASliceRangeMayBeInverted) {
  const auto range = sliceRangeOf("300,-1000.5");
  ASSERT_TRUE(range);
  EXPECT_EQ(range->black, 300);
  EXPECT_EQ(range->white, -1000.5);
  for (const char* bad : {"", "1", "1,1", "1,1.00000000001", "nan,1", "0,inf", "0,1e39", "0,1,2"})
    EXPECT_FALSE(sliceRangeOf(bad)) << bad;  // of the fourth, both are the same float
}

}  // namespace view_words_test
}  // namespace palpate
