// SPDX-License-Identifier: Apache-2.0
// Planes against points of the volume's box, which is turned and left-handed.
#include "apps/render/asked_style.hpp"

#include <random>

#include <gmock/gmock.h>

#include "apps/render/view_words.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace asked_style_test {

using testing::HasSubstr;
using testing::StartsWith;

const Vec3i kSize(41, 61, 22);

Lattice turned() {
  Lattice lattice;
  lattice.origin_W = {0.1, -0.2, 0.05};
  lattice.R_WL = Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  lattice.R_WL.col(1) *= -1;
  lattice.spacing_m = {0.7e-3, 0.9e-3, 1.3e-3};
  return lattice;
}

// 0 to 40, 60 and 21 mm, from the world's origin.
const Lattice kStraight;

RenderRequest with(const std::vector<std::string>& clips, const std::vector<std::string>& slices = {}) {
  RenderRequest request;
  for (const std::string& text : clips) request.clips.push_back(*planeOf(text));
  for (const std::string& text : slices) request.slices.push_back(*planeOf(text));
  return request;
}

std::string refusal(const std::vector<std::string>& clips, const std::vector<std::string>& slices = {}) {
  return refusalOf([&] { (void)styleOf(with(clips, slices), kStraight, kSize); });
}

// How far points reach along a direction.
double reachOf(const std::vector<Vec3>& points, const Vec3& direction) {
  double reach = -1e9;
  for (const Vec3& point : points) reach = std::max(reach, direction.dot(point));
  return reach;
}

TEST(AskedStyle, HasWhatWasAskedFor) {
  RenderRequest request = with({"x=3"}, {"-z=4"});
  request.second = -300;
  request.second_opacity = 0.25;
  request.slice_range = SliceRange{7, -5};
  DrawStyle style = styleOf(request, kStraight, kSize);
  ASSERT_EQ(style.clips.size(), 1U);
  EXPECT_EQ(style.clips[0].normal_W, Vec3::UnitX());
  EXPECT_EQ(style.clips[0].offset_m, 0.003);
  ASSERT_EQ(style.slices.size(), 1U);
  EXPECT_EQ(style.slices[0].normal_W, -Vec3::UnitZ());
  EXPECT_EQ(style.slices[0].offset_m, -0.004);
  EXPECT_EQ(style.other_isovalue, -300);
  EXPECT_EQ(style.other_opacity, 0.25);
  EXPECT_EQ(style.slice_black, 7);
  EXPECT_EQ(style.slice_white, -5);
  EXPECT_EQ(style.occlusion, DrawStyle{}.occlusion);
  EXPECT_FALSE(style.normals);
  request = {};
  request.occlusion = true;
  EXPECT_TRUE(styleOf(request, kStraight, kSize).occlusion);
  request.normals = true;
  style = styleOf(request, kStraight, kSize);
  EXPECT_TRUE(style.normals);
  EXPECT_FALSE(style.occlusion);
  EXPECT_EQ(style.slice_white, DrawStyle{}.slice_white);
}

// Between the two corners that lie farthest along the normal. 1e-15: roundings of some 0.3 m.
TEST(AskedStyle, AShareIsOfTheExtentAlongTheNormal) {
  const Lattice lattice = turned();
  const std::vector<Vec3> corners = clippedCorners(lattice, kSize, {});
  ASSERT_EQ(corners.size(), 8U);
  for (const char* direction : {"x=", "-y=", "z=", "0.5,-1,2@"}) {
    for (const double percent : {0.0, 12.5, 50.0, 100.0}) {
      const std::string text = direction + std::to_string(percent) + "%";
      const ViewPlane plane = styleOf(with({}, {text}), lattice, kSize).slices.front();
      const double share = text.front() == '-' ? 1 - percent / 100 : percent / 100;
      const double low_m = -reachOf(corners, -plane.normal_W), high_m = reachOf(corners, plane.normal_W);
      EXPECT_NEAR(plane.offset_m, low_m + share * (high_m - low_m), 1e-15) << text;
    }
  }
}

TEST(AskedStyle, RefusesASliceBesideTheVolume) {
  EXPECT_EQ(refusal({}, {"x=0", "x=40", "z=21", "y=0%", "-y=0%"}), kNoRefusal);
  EXPECT_EQ(refusal({}, {"y=60.1"}),
            "--slice: 'y=60.1' lies beside the volume, which reaches from 0,0,0 to 40,60,21 mm; give a place in it, or "
            "a share of it like 50%");
  EXPECT_THAT(refusal({}, {"x=3", "-z=-1"}), StartsWith("--slice: '-z=-1' lies beside"));
  EXPECT_THAT(refusal({}, {"1,1,0@71"}), StartsWith("--slice: '1,1,0@71' lies beside"));  // its corner is 70.7 mm away
  EXPECT_EQ(refusal({}, {"1,1,0@70.5"}), kNoRefusal);
}

// Where x is above 20 and y above 30 mm, (x + y) / sqrt(2) is above 35.36 mm.
TEST(AskedStyle, RefusesClipsThatLeaveNothing) {
  EXPECT_EQ(refusal({"y=60.1"}),
            "--clip: nothing is left of the volume, which reaches from 0,0,0 to 40,60,21 mm; move a plane, or turn it "
            "round with a minus");
  using Texts = std::vector<std::string>;
  for (const Texts& texts : {Texts{"-x=-1"}, Texts{"x=30", "-x=20"}, Texts{"z=100%"}, Texts{"x=20", "-x=20"},
                             Texts{"1,1,0@71"}, Texts{"x=20", "y=30", "-1,-1,0@-35.3"}})
    EXPECT_THAT(refusal(texts), HasSubstr("nothing is left of the volume")) << texts.front();
  for (const Texts& texts : {Texts{"y=59.9"}, Texts{"x=20", "-x=20.1"}, Texts{"z=0%", "-z=100%"}, Texts{"1,1,0@70.5"},
                             Texts{"x=20", "y=30", "-1,-1,0@-35.4"}})
    EXPECT_EQ(refusal(texts), kNoRefusal) << texts.front();
}

// Up to six planes near the middle. Every point of the box in front of all of them is in the hull of the corners, and
// every corner is in front of all of them. 1e-9: of places, as a share of the extent of 0.07 m.
TEST(AskedStyle, CornersHoldWhatIsLeft) {
  const Lattice lattice = turned();
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const auto direction = [&] { return Vec3(normal(random), normal(random), normal(random)).normalized(); };
  const Vec3 last_L = (kSize - Vec3i::Ones()).cast<double>();
  const Vec3 middle_W = lattice.toWorld(last_L / 2);
  for (std::size_t count = 1; count <= 6; ++count) {
    std::vector<ViewPlane> clips(count);
    for (ViewPlane& clip : clips) {
      const Vec3 unit_W = direction();
      clip = {3 * unit_W, 3 * (unit_W.dot(middle_W) - 0.004)};  // a normal of any length
    }
    const auto isLeft = [&](const Vec3& p_W) {
      return std::all_of(clips.begin(), clips.end(),
                         [&](const ViewPlane& clip) { return clip.normal_W.dot(p_W) >= clip.offset_m - 1e-9; });
    };
    const std::vector<Vec3> corners = clippedCorners(lattice, kSize, clips);
    ASSERT_GE(corners.size(), 4U);
    for (const Vec3& corner_W : corners) EXPECT_TRUE(isLeft(corner_W));
    std::vector<Vec3> left;
    for (int n = 0; n < 21 * 21 * 21; ++n) {
      const Vec3i step(n % 21, n / 21 % 21, n / 441);
      const Vec3 p_W = lattice.toWorld(step.cast<double>().cwiseProduct(last_L) / 20);
      if (isLeft(p_W)) left.push_back(p_W);
    }
    ASSERT_GT(left.size(), 10U);
    for (int n = 0; n < 200; ++n) {
      const Vec3 along = direction();
      EXPECT_LE(reachOf(left, along), reachOf(corners, along) + 1e-9) << count;
    }
  }
}

// Three planes cut out an octant whose corner is in the middle of the box.
TEST(AskedStyle, CornersMayLieWithinTheBox) {
  const RenderRequest request = with({"x=10", "y=20", "-z=5"});
  const auto corners = clippedCorners(kStraight, kSize, styleOf(request, kStraight, kSize).clips);
  ASSERT_EQ(corners.size(), 8U);
  EXPECT_NEAR(reachOf(corners, -Vec3::UnitX()), -0.010, 1e-15);
  EXPECT_NEAR(reachOf(corners, -Vec3::UnitY()), -0.020, 1e-15);
  EXPECT_NEAR(reachOf(corners, Vec3::UnitZ()), 0.005, 1e-15);
  EXPECT_NEAR(reachOf(corners, Vec3::Ones()), 0.040 + 0.060 + 0.005, 1e-15);
}

}  // namespace asked_style_test
}  // namespace palpate
