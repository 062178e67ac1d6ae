// SPDX-License-Identifier: Apache-2.0
// With PALPATE_SHOW=FOLDER in the environment the pictures and a report are written there, to be looked at.
#include "apps/view/compose_view.hpp"

#include <cstdlib>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/report/html_report.hpp"
#include "apps/report/words.hpp"
#include "base/atomic_file.hpp"
#include "base/error.hpp"
#include "decoded.hpp"
#include "synthetic_run.hpp"

namespace palpate {
namespace compose_view_test {

// Pixels of a box whose colour is within 40 of a colour in each channel.
int countNear(const Decoded& image, const PanelBox& box, int red, int green, int blue) {
  int count = 0;
  for (int y = box.y; y < box.y + box.height; ++y) {
    for (int x = box.x; x < box.x + box.width; ++x) {
      const auto c = image.at(x, y);
      const int r = static_cast<int>(c >> 16), g = static_cast<int>(c >> 8 & 255), b = static_cast<int>(c & 255);
      count += std::abs(r - red) < 40 && std::abs(g - green) < 40 && std::abs(b - blue) < 40;
    }
  }
  return count;
}

// Pixels that two pictures of one size do not share, within a box.
int countChanged(const Decoded& a, const Decoded& b, const PanelBox& box) {
  int count = 0;
  for (int y = box.y; y < box.y + box.height; ++y) {
    for (int x = box.x; x < box.x + box.width; ++x) count += a.at(x, y) != b.at(x, y);
  }
  return count;
}

class ComposeView : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    field_ = std::make_unique<AnalyticField>(bumpySphere());
    run_ = std::make_unique<TouchRun>(syntheticRun(*field_, {}));
    view_ = std::make_unique<SyntheticView>(viewOf(*field_, *run_, 1280, 720));
    png_ = std::make_unique<std::string>(composeView(view_->layout, view_->pictures, view_->region, *run_));
  }
  static inline std::unique_ptr<AnalyticField> field_;
  static inline std::unique_ptr<TouchRun> run_;
  static inline std::unique_ptr<SyntheticView> view_;
  static inline std::unique_ptr<std::string> png_;
};

TEST_F(ComposeView, IsAPngOfTheAskedSize) {
  EXPECT_TRUE(png_->starts_with("\x89PNG\r\n\x1a\n"));
  const Decoded image = decode(*png_);
  EXPECT_EQ(image.width, 1280);
  EXPECT_EQ(image.height, 720);
  if (const char* folder = std::getenv("PALPATE_SHOW")) {
    writeFileAtomically(std::string(folder) + "/view.png", *png_);
    writeReport(std::string(folder) + "/report.html", *run_, *png_);
    std::puts(closingSummary(*run_).c_str());
  }
}

TEST_F(ComposeView, ShowsPathForcesMarksAndWords) {
  const Decoded image = decode(*png_);
  const PanelBox& close_up = view_->layout.close_up;
  EXPECT_GT(countNear(image, view_->layout.overview, 18, 92, 199), 100);  // the tool's way
  EXPECT_GT(countNear(image, close_up, 18, 92, 199), 300);
  EXPECT_GT(countNear(image, close_up, 13, 13, 18), 300);  // the way on the surface
  EXPECT_GT(countNear(image, close_up, 204, 28, 56) + countNear(image, close_up, 107, 13, 115), 300);  // strong forces
  EXPECT_GT(countNear(image, close_up, 26, 153, 64), 50);                                              // start
  EXPECT_GT(countNear(image, close_up, 217, 38, 38), 50);                                              // end
  // Ink covers some per cent of a line of text, neither nothing nor all.
  for (const PanelBox& words : {PanelBox{16, 12, 500, 20}, PanelBox{16, 720 - 52, 500, 20}}) {
    const double share = countNear(image, words, 28, 33, 41) / (500.0 * 20);
    EXPECT_GT(share, 0.02);
    EXPECT_LT(share, 0.5);
  }
}

// What every panel has, where it belongs: captions at the top left, scale bars at the bottom left, marks, outlines, and
// the square around the close-up in the overview alone.
TEST_F(ComposeView, EveryPanelHasItsParts) {
  TouchRun run = *run_;
  run.object_outlines = {{}};
  for (int i = 0; i <= 100; ++i) run.object_outlines[0].push_back(Vec3(-15e-3 + 0.3e-3 * i, 0, 18e-3));
  const Decoded image = decode(composeView(view_->layout, view_->pictures, view_->region, run));
  const Decoded plain = decode(*png_);
  for (const PanelBox& box : {view_->layout.overview, view_->layout.close_up}) {
    SCOPED_TRACE(box.x);
    const PanelBox caption = {box.x + 14, box.y + 10, 120, 22};
    const PanelBox bar = {box.x + 14, box.y + box.height - 40, 160, 30};
    EXPECT_GT(countNear(image, caption, 28, 33, 41), 60);
    EXPECT_GT(countNear(image, bar, 28, 33, 41), 60);
    EXPECT_GT(countNear(image, box, 26, 153, 64), 40);   // start
    EXPECT_GT(countNear(image, box, 217, 38, 38), 40);   // end
    EXPECT_GT(countChanged(image, plain, box), 50);      // the outline
    EXPECT_GT(countNear(image, box, 115, 77, 158), 20);  // in its colour
  }
  EXPECT_GT(countNear(image, view_->layout.overview, 217, 89, 13), 60);
  EXPECT_LT(countNear(image, view_->layout.close_up, 217, 89, 13),
            countNear(image, view_->layout.overview, 217, 89, 13));
}

// A point counts as on the surface if it lies no more below it than two pixels, seen from the contact's distance, or
// half of the smallest voxel edge. The picture's surface is put that much in front of the tool's way, and a little less
// or more.
TEST_F(ComposeView, HidesWhatIsDeeperThanItsTolerance) {
  const Camera& camera = view_->pictures.close_up_camera;
  const double depth_m = (view_->region.centre_W - camera.position_W).dot(camera.forward_W);
  const double two_pixels_m = 2 * camera.pixelSize(depth_m);
  for (const Vec3& spacing_m : {Vec3(1e-6, 1e-6, 1e-6), Vec3(Vec3(40, 8, 20) * two_pixels_m)}) {
    TouchRun run = *run_;
    run.volume.spacing_m = spacing_m;
    for (TickRecord& r : run.records) r.in_contact = false;  // the HIP's way alone
    const double tolerance_m = std::max(two_pixels_m, 0.5 * spacing_m.minCoeff());
    const auto fullyBlue = [&](double above_m) {
      ViewPictures pictures = view_->pictures;
      std::vector<float>& distance_m = pictures.close_up.distance_m;
      std::fill(distance_m.begin(), distance_m.end(), std::numeric_limits<float>::infinity());
      for (const TickRecord& r : run.records) {
        const auto p = camera.project(Vec3(r.hip_W));
        if (!p || p->x < 0 || p->y < 0 || p->x >= camera.width || p->y >= camera.height) continue;
        float& its = distance_m[static_cast<std::size_t>(p->y) * static_cast<std::size_t>(camera.width) +
                                static_cast<std::size_t>(p->x)];
        its = std::min(its, static_cast<float>(p->distance_m - above_m));
      }
      return countNear(decode(composeView(view_->layout, pictures, view_->region, run)), view_->layout.close_up, 18, 92,
                       199);
    };
    const int open = fullyBlue(-1), just = fullyBlue(0.6 * tolerance_m), hidden = fullyBlue(1.6 * tolerance_m);
    EXPECT_GT(just, 0.9 * open) << spacing_m.transpose();
    EXPECT_LT(hidden, 0.7 * open) << spacing_m.transpose();
  }
}

// The same path before a picture in which nothing hides it is drawn solid: more of the full colour.
TEST_F(ComposeView, DrawsHiddenPartsFainter) {
  ViewPictures clear = view_->pictures;
  for (float& d : clear.close_up.distance_m) d = std::numeric_limits<float>::infinity();
  const Decoded solid = decode(composeView(view_->layout, clear, view_->region, *run_)), image = decode(*png_);
  const PanelBox& box = view_->layout.close_up;
  EXPECT_GT(countNear(solid, box, 18, 92, 199), countNear(image, box, 18, 92, 199) + 300);
}

TEST_F(ComposeView, ARunWithoutContactIsStillAPicture) {
  TouchRun run = *run_;
  for (TickRecord& r : run.records) {
    r.in_contact = false;
    for (double& f : r.force_W) f = 0;
  }
  const ContactRegion region = findContactRegion(run.records, 4e-3);
  const Decoded image = decode(composeView(view_->layout, view_->pictures, region, run));
  EXPECT_GT(countChanged(image, decode(*png_), view_->layout.close_up), 300);
  EXPECT_EQ(image.width, 1280);
  run.records.clear();
  EXPECT_EQ(decode(composeView(view_->layout, view_->pictures, findContactRegion({}, 4e-3), run)).height, 720);
}

// The second line of the legend. Where nothing is felt it says so, and no line for the depth is drawn over the words.
TEST_F(ComposeView, TheLegendNamesTheDepthOnlyWhereThereIsAForce) {
  TouchRun run = *run_;
  for (TickRecord& r : run.records) {
    r.in_contact = false;
    for (double& f : r.force_W) f = 0;
  }
  const PanelBox& panel = view_->layout.overview;
  const PanelBox line = {16, panel.y + panel.height + 36, 1200, 18};
  const auto thinBlue = [&](const std::string& png) {  // four fifths of the tool's blue, the rest white
    return countNear(decode(png), line, 65, 125, 210);
  };
  const std::string none = composeView(view_->layout, view_->pictures, findContactRegion(run.records, 4e-3), run);
  EXPECT_GT(thinBlue(*png_), 30);
  EXPECT_EQ(thinBlue(none), 0);
  EXPECT_GT(countNear(decode(none), {16, line.y, 80, line.height}, 28, 33, 41), 30);  // the words
}

TEST_F(ComposeView, ANameThatIsNotUtf8IsNoTrouble) {
  TouchRun run = *run_;
  run.volume.name = "scan\xff\xc3(\xe2\x82";
  EXPECT_EQ(decode(composeView(view_->layout, view_->pictures, view_->region, run)).width, 1280);
}

// A large file takes seconds, and who waits may have had enough.
TEST_F(ComposeView, IsEndedBetweenTwoPiecesOfTheFile) {
  int pieces = 0;
  const auto stop = [&] {
    if (++pieces == 3) throw std::runtime_error("enough");
  };
  EXPECT_THROW((void)composeView(view_->layout, view_->pictures, view_->region, *run_, stop), std::runtime_error);
  EXPECT_EQ(pieces, 3);
  EXPECT_EQ(composeView(view_->layout, view_->pictures, view_->region, *run_, [&] { ++pieces; }), *png_);
  EXPECT_GT(pieces, 10);
}

TEST_F(ComposeView, RefusesAPictureOfAnotherSize) {
  ViewPictures wrong = view_->pictures;
  wrong.close_up.width -= 1;
  EXPECT_THROW((void)composeView(view_->layout, wrong, view_->region, *run_), Error);
  for (const auto change :
       {+[](ViewPictures& p) { p.overview_camera.width += 1; }, +[](ViewPictures& p) { p.close_up_camera.height += 1; },
        +[](ViewPictures& p) { p.overview.distance_m.pop_back(); }}) {
    wrong = view_->pictures;
    change(wrong);
    EXPECT_THROW((void)composeView(view_->layout, wrong, view_->region, *run_), Error);
  }
}

TEST(LayOutView, PanelsLieBesideEachOtherInsideThePicture) {
  for (const auto& [width, height] :
       {std::pair(480, 270), std::pair(1280, 720), std::pair(1000, 1000), std::pair(3840, 2160)}) {
    const ViewLayout layout = layOutView(width, height);
    EXPECT_GT(layout.overview.x, 0);
    EXPECT_GT(layout.close_up.x, layout.overview.x + layout.overview.width);
    EXPECT_LT(layout.close_up.x + layout.close_up.width, width);
    EXPECT_LT(layout.close_up.y + layout.close_up.height, height);
    EXPECT_GT(layout.overview.width, width / 4);
  }
}

// Title 62, legend 64, borders 8 at scale 1; the overview has 0.4 of the width, with half a border between the panels.
TEST(LayOutView, DividesThePicture) {
  const auto expectLayout = [](int width, int height, double scale, const PanelBox& overview,
                               const PanelBox& close_up) {
    const ViewLayout layout = layOutView(width, height);
    EXPECT_EQ(layout.width, width);
    EXPECT_EQ(layout.height, height);
    EXPECT_DOUBLE_EQ(layout.scale, scale);
    for (const auto& [is, wanted] : {std::pair(layout.overview, overview), std::pair(layout.close_up, close_up)}) {
      EXPECT_EQ(is.x, wanted.x);
      EXPECT_EQ(is.y, wanted.y);
      EXPECT_EQ(is.width, wanted.width);
      EXPECT_EQ(is.height, wanted.height);
    }
  };
  expectLayout(1280, 720, 1, {8, 62, 500, 594}, {516, 62, 756, 594});
  expectLayout(960, 540, 0.75, {6, 47, 375, 445}, {387, 47, 567, 445});
  expectLayout(640, 1000, 0.5, {4, 31, 250, 937}, {258, 31, 378, 937});
}

TEST(LayOutView, RefusesImpossibleSizes) {
  for (const auto& [width, height] : {std::pair(480, 270), std::pair(16384, 16384)}) {
    EXPECT_NO_THROW((void)layOutView(width, height));
  }
  for (const auto& [width, height] : {std::pair(479, 270), std::pair(480, 269), std::pair(16385, 270)}) {
    try {
      (void)layOutView(width, height);
      ADD_FAILURE() << width;
    } catch (const Error& error) {
      EXPECT_EQ(error.what(), "image size: " + std::to_string(width) + " x " + std::to_string(height) +
                                  " pixels cannot be drawn; ask for 480 x 270 to 16384 x 16384");
    }
  }
}

}  // namespace compose_view_test
}  // namespace palpate
