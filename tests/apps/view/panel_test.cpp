// SPDX-License-Identifier: Apache-2.0
// Drawn at scale 2 on a plain picture of 400 x 300 pixels. The camera looks down from 1 m; there, at z = 0, a
// millimetre is a pixel, and the world's origin is in the middle.
#include "apps/view/panel.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "decoded.hpp"

namespace palpate {
namespace panel_test {

constexpr Color kWhite = {1, 1, 1}, kBox = {0.85, 0.35, 0.05};

class PanelTest : public ::testing::Test {
 protected:
  PanelTest() {
    camera_.position_W = Vec3(0, 0, 1);
    camera_.vertical_fov_rad = 2 * std::atan(0.15);
    camera_.width = image_.width = 400;
    camera_.height = image_.height = 300;
    image_.distance_m.assign(std::size_t{400} * 300, std::numeric_limits<float>::infinity());
  }
  // The surface is in front of everything in these columns.
  void hide(int begin, int end) {
    for (int y = 0; y < 300; ++y) {
      for (int x = begin; x < end; ++x) image_.distance_m[400 * static_cast<std::size_t>(y) + x] = 0.5F;
    }
  }
  template <typename Draw>
  Decoded drawn(Draw draw) {
    const std::unique_ptr<Canvas> picture = makeCanvas(400, 300);
    Canvas& canvas = *picture;
    Panel panel(canvas, camera_, image_, 1e-3, 2);
    draw(panel);
    return decode(canvas.png());
  }
  Camera camera_;
  RenderedImage image_;
};

TickRecord tickAt(double x_mm, double y_mm, bool in_contact = false) {
  TickRecord r;
  r.hip_W[0] = r.vhip_W[0] = x_mm * 1e-3;
  r.hip_W[1] = r.vhip_W[1] = y_mm * 1e-3;
  r.in_contact = in_contact;
  return r;
}

// 200 mm to the right, 50 mm above the middle: y = 100, 4.8 wide. Hidden, it has dashes of 10 and gaps of 8, and is
// four fifths as wide.
TEST_F(PanelTest, ThePathIsSolidOrDashed) {
  std::vector<TickRecord> records;
  for (int i = 0; i <= 40; ++i) records.push_back(tickAt(-100 + 5 * i, 50));
  hide(0, 200);
  const Decoded image = drawn([&](Panel& panel) { panel.drawHipPath(records); });
  EXPECT_EQ(countColor(image, 205, 98, 296, 102, kHipColor), 91 * 4);
  EXPECT_EQ(countColor(image, 0, 0, 195, 300, kHipColor), 0);
  const Color faded = kHipColor.faded(0.55);
  EXPECT_EQ(countColor(image, 101, 99, 109, 101, faded), 8 * 2);
  EXPECT_EQ(countColor(image, 111, 99, 117, 101, kWhite), 6 * 2);
  EXPECT_EQ(countColor(image, 119, 99, 127, 101, faded), 8 * 2);
  EXPECT_EQ(countColor(image, 101, 96, 109, 98, kWhite), 8 * 2);
  EXPECT_TRUE(hasColor(image, 97, 100, kWhite) && hasColor(image, 304, 100, kWhite));
}

// The rim is 2.2 wider than the line, at scale 2 twice that.
TEST_F(PanelTest, ThePathHasALightRim) {
  const std::unique_ptr<Canvas> picture = makeCanvas(400, 300);
  Canvas& canvas = *picture;
  canvas.fillRectangle(0, 0, 400, 300, {0, 0, 0});
  Panel panel(canvas, camera_, image_, 1e-3, 2);
  panel.drawHipPath({tickAt(-100, 0), tickAt(100, 0)});
  const Decoded image = decode(canvas.png());
  const Color light = {0.7, 0.7, 0.7};
  EXPECT_TRUE(hasColor(image, 200, 146, light) && hasColor(image, 200, 153, light));
  EXPECT_TRUE(hasColor(image, 200, 144, {0, 0, 0}) && hasColor(image, 200, 155, {0, 0, 0}));
}

TEST_F(PanelTest, TheWayOnTheSurfaceIsThatOfTheVhipInContact) {
  std::vector<TickRecord> records;
  for (int i = 0; i <= 40; ++i) {
    records.push_back(tickAt(-100 + 5 * i, 50, i <= 15 || i >= 25));
    records.back().hip_W[1] = -50e-3;
  }
  const Decoded image = drawn([&](Panel& panel) { panel.drawVhipPath(records); });
  EXPECT_EQ(countColor(image, 105, 98, 170, 102, kVhipColor), 65 * 4);
  EXPECT_EQ(countColor(image, 230, 98, 295, 102, kVhipColor), 65 * 4);
  EXPECT_EQ(countColor(image, 180, 90, 220, 110, kWhite), 40 * 20);
  EXPECT_EQ(countColor(image, 0, 190, 400, 210, kWhite), 400 * 20);
}

TEST_F(PanelTest, OutlinesOfObjectsAreLines) {
  const Decoded image = drawn([](Panel& panel) {
    panel.drawObjects(
        {{Vec3(-0.1, 0.05, 0), Vec3(0.1, 0.05, 0)}, {Vec3(0, 0, 2)}, {Vec3(0, -0.05, 0), Vec3(0, -0.1, 0)}});
  });
  EXPECT_EQ(countColor(image, 105, 99, 295, 101, kObjectColor), 190 * 2);
  EXPECT_EQ(countColor(image, 199, 205, 201, 245, kObjectColor), 40 * 2);
}

// 2 N of 4 N: half of the longest arrow, 60 pixels up, in the colour between. The tool is 20 pixels below.
TEST_F(PanelTest, ArrowsShowTheirForceAndTheDepth) {
  ForceArrows forces;
  forces.most_N = 4;
  forces.arrows = {{Vec3(0, -0.02, 0), Vec3::Zero(), Vec3(0, 2, 0)}};
  const auto draw = [&](Panel& panel) { panel.drawForces(forces, 0.12); };
  const Color color = {0.87, 0.265, 0.16};
  Decoded image = drawn(draw);
  EXPECT_EQ(countColor(image, 198, 120, 202, 140, color), 4 * 20);
  EXPECT_TRUE(hasColor(image, 199, 93, color) && hasColor(image, 199, 88, kWhite));
  EXPECT_EQ(countColor(image, 198, 168, 202, 172, kHipColor), 4 * 4);
  EXPECT_TRUE(hasColor(image, 200, 180, kWhite) && hasColor(image, 200, 150, kWhite));
  EXPECT_FALSE(hasColor(image, 205, 149, kWhite));  // the rim of its foot
  EXPECT_TRUE(hasColor(image, 199, 160, kHipColor.faded(0.8)));
  hide(0, 400);
  image = drawn(draw);
  EXPECT_EQ(countColor(image, 198, 120, 202, 140, color.faded(0.55)), 4 * 20);
  forces.most_N = 0;
  EXPECT_EQ(countColor(drawn(draw), 0, 0, 400, 300, kWhite), 400 * 300);
}

// At 2 m a pixel is 2 mm: 120 mm are 60 pixels to each side. Lines are 4 wide.
TEST_F(PanelTest, TheBoxIsAroundItsRegionAndItsWordsBelow) {
  ContactRegion region;
  region.centre_W = Vec3(0, 0, -1);
  region.radius_m = 0.12;
  Decoded image = drawn([&](Panel& panel) { panel.drawBox(region, "close-up"); });
  EXPECT_EQ(countColor(image, 138, 95, 142, 205, kBox), 4 * 110);
  EXPECT_EQ(countColor(image, 258, 95, 262, 205, kBox), 4 * 110);
  EXPECT_EQ(countColor(image, 145, 88, 255, 92, kBox), 110 * 4);
  EXPECT_EQ(countColor(image, 145, 208, 255, 212, kBox), 110 * 4);
  EXPECT_GT(countColor(image, 100, 222, 300, 252, kBox), 100);
  EXPECT_EQ(countColor(image, 145, 95, 255, 205, kWhite), 110 * 110);
  EXPECT_EQ(countColor(image, 0, 0, 400, 85, kWhite), 400 * 85);
  // Near the lower border they stand above; a small region has a box of 16 pixels to each side all the same.
  region.centre_W = Vec3(0, -0.1, 0);
  region.radius_m = 1e-3;
  image = drawn([&](Panel& panel) { panel.drawBox(region, "close-up"); });
  EXPECT_EQ(countColor(image, 182, 240, 186, 260, kBox), 4 * 20);
  EXPECT_EQ(countColor(image, 214, 240, 218, 260, kBox), 4 * 20);
  EXPECT_GT(countColor(image, 100, 195, 300, 228, kBox), 100);
  EXPECT_EQ(countColor(image, 0, 272, 400, 300, kWhite), 400 * 28);
  // Beside the right border they are moved in; behind the camera there is nothing.
  region.centre_W = Vec3(0.195, 0, 0);
  image = drawn([&](Panel& panel) { panel.drawBox(region, "close-up"); });
  EXPECT_EQ(countColor(image, 393, 175, 400, 210, kWhite), 7 * 35);
  EXPECT_GT(countColor(image, 200, 175, 393, 210, kBox), 100);
  region.centre_W = Vec3(0, 0, 2);
  EXPECT_EQ(countColor(drawn([&](Panel& panel) { panel.drawBox(region, "no"); }), 0, 0, 400, 300, kWhite), 400 * 300);
}

// At 1.2 m a pixel is 1.2 mm, and a quarter of the width 120 mm: 100 mm are 83 pixels, from x = 32 on, y = 268.
TEST_F(PanelTest, TheScaleBarIsAsLongAsItSays) {
  const Decoded image = drawn([](Panel& panel) { panel.drawScaleBar(Vec3(0.05, 0.02, -0.2)); });
  EXPECT_EQ(countColor(image, 35, 266, 112, 270, kInk), 77 * 4);
  EXPECT_EQ(countColor(image, 30, 259, 34, 265, kInk), 4 * 6);
  EXPECT_EQ(countColor(image, 114, 259, 117, 265, kInk), 3 * 6);
  EXPECT_EQ(countColor(image, 36, 255, 111, 265, kWhite), 75 * 10);
  EXPECT_EQ(countColor(image, 120, 256, 400, 300, kWhite), 280 * 44);
  EXPECT_EQ(countColor(image, 0, 272, 400, 300, kWhite), 400 * 28);
  EXPECT_GT(countColor(image, 20, 228, 130, 253, kInk), 150);
  EXPECT_EQ(countColor(image, 0, 0, 400, 225, kWhite), 400 * 225);
  EXPECT_EQ(countColor(drawn([](Panel& panel) { panel.drawScaleBar(Vec3(0, 0, 1)); }), 0, 0, 400, 300, kWhite),
            400 * 300);
}

TEST_F(PanelTest, TheCaptionIsAtTheTopLeft) {
  const Decoded image = drawn([](Panel& panel) { panel.drawCaption("Whole"); });
  EXPECT_GT(countColor(image, 32, 26, 160, 56, kInk), 300);
  EXPECT_EQ(countColor(image, 0, 0, 30, 300, kWhite), 30 * 300);
  EXPECT_EQ(countColor(image, 0, 58, 400, 300, kWhite), 400 * 242);
}

// A disc of radius 12 at each end, and a word beside it; more words where the path begins or ends beside the picture.
TEST_F(PanelTest, EndsHaveMarksAndWords) {
  const auto ends = [&](const std::vector<TickRecord>& records) {
    return drawn([&](Panel& panel) { panel.drawEnds(records); });
  };
  const auto all = [](const Decoded& image, const Color& color) { return countColor(image, 0, 0, 400, 300, color); };
  const Decoded two = ends({tickAt(-100, 0), tickAt(0, 50), tickAt(100, 0)});
  EXPECT_EQ(countColor(two, 95, 145, 105, 155, kStartColor), 100);
  EXPECT_EQ(countColor(two, 295, 145, 305, 155, kEndColor), 100);
  EXPECT_GT(countColor(two, 114, 130, 286, 170, kStartColor), 50);
  EXPECT_GT(all(two, kEndColor), countColor(two, 285, 135, 315, 165, kEndColor) + 50);
  EXPECT_EQ(all(two, kInk), 0);
  // x = 20 and 380 are nearer to the border than 28 pixels.
  const Decoded cut = ends({tickAt(-180, 0), tickAt(-100, 0), tickAt(0, 50), tickAt(100, 0), tickAt(180, 0)});
  EXPECT_EQ(countColor(cut, 95, 145, 105, 155, kStartColor), 100);
  EXPECT_GT(all(cut, kStartColor), all(two, kStartColor) + 50);  // "from start"
  EXPECT_GT(all(cut, kEndColor), all(two, kEndColor) + 30);      // "to end"
  // At 35 pixels, less than 40, both have one label in ink; at 60 each has its own.
  const Decoded one = ends({tickAt(0, 0), tickAt(0, 50), tickAt(35, 0)});
  EXPECT_EQ(all(one, kStartColor), countColor(one, 185, 135, 215, 165, kStartColor));
  EXPECT_GT(all(one, kInk), 200);
  EXPECT_EQ(all(ends({tickAt(0, 0), tickAt(0, 50), tickAt(60, 0)}), kInk), 0);
  EXPECT_EQ(all(ends({tickAt(-500, 0), tickAt(500, 0)}), kWhite), 400 * 300);
}

}  // namespace panel_test
}  // namespace palpate
