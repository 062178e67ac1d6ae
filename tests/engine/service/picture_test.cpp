// SPDX-License-Identifier: Apache-2.0
// The picture that is kept up to date while the volume is edited, against one that is drawn anew.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "engine/edit/random_edits.hpp"
#include "engine/phantoms/phantom.hpp"
#include "engine/service/engine.hpp"

namespace palpate {
namespace picture_test {

constexpr int kWidth = 61, kHeight = 47;

Camera cameraTo(const Volume& volume, double distance_m) {
  const Vec3 middle_W = volume.lattice().toWorld((volume.size().cast<double>().array() - 1) / 2);
  return lookAt(middle_W, Vec3(0.6, -0.64, 0.48), distance_m, Vec3::UnitZ(), kWidth, kHeight, 0.6);
}

// How many pixels differ, in colour or distance, bit for bit.
int differing(const RenderedImage& a, const RenderedImage& b) {
  int count = 0;
  for (std::size_t i = 0; i < a.distance_m.size(); ++i) {
    count += a.distance_m[i] != b.distance_m[i] || !std::equal(&a.rgba[4 * i], &a.rgba[4 * i] + 4, &b.rgba[4 * i]);
  }
  return count;
}

void drawAll(Engine& engine) {
  while (!engine.drawPiece(1e-3)) {
  }
}

struct Case {
  std::string volume;
  std::string filter;
  bool occlusion = false;
  bool second = false;
  bool coarse = false;
  bool cut = false;     // clipping and slice planes, normals
  bool within = false;  // the camera is in the volume
};

// After each of many edits of all kinds, and in between while pieces are under way: the picture is that of a new engine
// for the edited volume, pixel by pixel, and of a new drawing of the same engine.
void expectPictureFollows(const Case& c, int edits, unsigned seed) {
  const auto phantom = makePhantom(c.volume);
  Volume volume = makeVolume(*phantom);
  const Plan plan = makePlan({.filter = c.filter, .edits = true, .draws = true});
  Engine engine(volume, plan, phantom->isovalue(), "");
  engine.allowEdits(brushProfile(volume, phantom->isovalue()));
  const double extent_m = volume.size().cast<double>().cwiseProduct(volume.lattice().spacing_m).norm();
  const Camera camera = cameraTo(volume, (c.within ? 0.2 : 1.2) * extent_m);
  DrawStyle style;
  style.occlusion = c.occlusion;
  if (c.cut) {
    style.normals = true;
    style.clips = {{Vec3(1, 0.2, 0), 0}, {Vec3(0, 1, -1), -0.1 * extent_m}};
    style.slices = {{Vec3(0, 0.1, 1), 0}};
  }
  if (c.second) style.other_isovalue = phantom->isovalue() - 200;
  engine.show(camera, style, c.coarse ? DrawOrder::kCoarseFirst : DrawOrder::kWhole);
  drawAll(engine);
  RandomEdits random(volume.size(), volume.lattice(), phantom->isovalue() - 400, phantom->isovalue() + 400, seed);
  RenderedImage before = engine.picture();
  int visible = 0, untouched = 0;
  for (int n = 0; n < edits; ++n) {
    const std::array commands = {random.next()};
    engine.edit(commands, 0);
    if (n % 3 == 0) static_cast<void>(engine.drawPiece(1e-4));  // and the next edit comes while that is under way
    if (n % 3 == 0) continue;
    drawAll(engine);
    const RenderedImage now = engine.picture();
    ASSERT_EQ(differing(now, engine.draw(camera, {}, style)), 0) << "after edit " << n;
    const int changed = differing(now, before);
    visible += changed > 0;
    untouched += changed < kWidth * kHeight;
    before = now;
  }
  EXPECT_GT(visible, edits / 10);  // some edits lie behind the object or in its inside
  EXPECT_GT(untouched, edits / 3);
  engine.readBack(volume);
  Engine anew(volume, plan, phantom->isovalue(), "");
  EXPECT_EQ(differing(before, anew.draw(camera, {}, style)), 0);
}

TEST(Picture, FollowsEdits) {
  expectPictureFollows({"phantom:knot?size=61x53x47&spacing=0.8x1x1.2mm", ""}, 200, 5);
}

TEST(Picture, FollowsEditsWithOcclusionAndASecondIsosurface) {
  expectPictureFollows({"phantom:head?size=64", "", true, true}, 60, 6);
}

TEST(Picture, FollowsEditsOfAFilteredField) {
  expectPictureFollows({"phantom:knot?size=61x53x47&spacing=0.8x1x1.2mm", "gaussian:1"}, 40, 7);
}

TEST(Picture, FollowsEditsWhileItIsCoarse) {
  expectPictureFollows({"phantom:knot?size=61x53x47&spacing=0.8x1x1.2mm", "", false, false, true}, 40, 8);
}

TEST(Picture, FollowsEditsOfWhatIsCut) {
  Case c{"phantom:knot?size=61x53x47&spacing=0.8x1x1.2mm", ""};
  c.cut = true;
  expectPictureFollows(c, 40, 9);
}

TEST(Picture, FollowsEditsAroundACameraInTheVolume) {
  Case c{"phantom:gyroid?size=48", ""};
  c.within = true;
  expectPictureFollows(c, 40, 10);
}

// While edits come faster than their pixels, each pixel is that of the volume at the version that the picture says, or
// at a later one; and the version gets there.
TEST(Picture, KnowsUpToWhichEditItIsTrue) {
  const auto phantom = makePhantom("phantom:knot?size=61x53x47&spacing=0.8x1x1.2mm");
  const Volume volume = makeVolume(*phantom);
  Engine engine(volume, makePlan({.edits = true, .draws = true}), phantom->isovalue(), "");
  engine.allowEdits(brushProfile(volume, phantom->isovalue()));
  const Camera camera = cameraTo(volume, 0.12);
  engine.show(camera, {}, DrawOrder::kWhole);
  drawAll(engine);
  EXPECT_TRUE(engine.pictureState().whole);
  std::vector<RenderedImage> at_version = {engine.draw(camera)};
  RandomEdits random(volume.size(), volume.lattice(), phantom->isovalue() - 400, phantom->isovalue() + 400, 3);
  int behind = 0;
  const auto check = [&] {
    while (!engine.pollPicture()) std::this_thread::yield();
    const PictureState state = engine.pictureState();
    ASSERT_TRUE(state.fine);
    ASSERT_LT(state.version, at_version.size());
    behind += state.version + 1 < at_version.size();
    const RenderedImage now = engine.picture();
    for (std::size_t i = 0; i < now.distance_m.size(); ++i) {
      bool known = false;
      for (std::size_t v = state.version; v < at_version.size() && !known; ++v)
        known = now.distance_m[i] == at_version[v].distance_m[i];
      ASSERT_TRUE(known) << "pixel " << i << " is older than version " << state.version;
    }
  };
  for (int n = 0; n < 60; ++n) {
    const std::array commands = {random.next()};
    engine.edit(commands, 0);
    at_version.push_back(engine.draw(camera));
    static_cast<void>(engine.drawPiece(1e-12));  // a tile
    ASSERT_NO_FATAL_FAILURE(check());
  }
  EXPECT_GT(behind, 10);
  drawAll(engine);
  ASSERT_NO_FATAL_FAILURE(check());
  EXPECT_EQ(engine.pictureState().version, 60U);
  EXPECT_TRUE(engine.pictureState().whole);
}

// Making ready for edits replaces buffers that a piece under way reads.
TEST(Picture, MayBeUnderWayWhenEditsAreAllowed) {
  const auto phantom = makePhantom("phantom:knot?size=61x53x47");
  const Volume volume = makeVolume(*phantom);
  Engine engine(volume, makePlan({.filter = "median:1", .edits = true, .draws = true}), phantom->isovalue(), "");
  const Camera camera = cameraTo(volume, 0.12);
  engine.show(camera, {}, DrawOrder::kWhole);
  EXPECT_FALSE(engine.drawPiece(1));
  engine.allowEdits(brushProfile(volume, phantom->isovalue()));
  drawAll(engine);
  EXPECT_EQ(differing(engine.picture(), engine.draw(camera)), 0);
}

// Coarse or at once: in the end the pixels are the same.
TEST(Picture, IsTheSameInEitherOrder) {
  const auto phantom = makePhantom("phantom:knot?size=61x53x47");
  const Volume volume = makeVolume(*phantom);
  Engine engine(volume, makePlan({.draws = true}), phantom->isovalue(), "");
  const Camera camera = cameraTo(volume, 0.12);
  engine.show(camera, {}, DrawOrder::kCoarseFirst);
  drawAll(engine);
  const RenderedImage coarse_first = engine.picture();
  engine.show(camera, {}, DrawOrder::kWhole);
  drawAll(engine);
  EXPECT_EQ(differing(coarse_first, engine.picture()), 0);
  EXPECT_GT(std::ranges::count_if(coarse_first.distance_m, [](float d) { return std::isfinite(d); }), 300);
}

// Another isovalue: the picture is that of an engine that began with it.
TEST(Picture, ShowsAnotherIsovalue) {
  const auto phantom = makePhantom("phantom:knot?size=61x53x47");
  const Volume volume = makeVolume(*phantom);
  Engine engine(volume, makePlan({.other_isovalues = true, .draws = true}), phantom->isovalue(), "");
  const Camera camera = cameraTo(volume, 0.12);
  engine.show(camera, {}, DrawOrder::kWhole);
  drawAll(engine);
  const RenderedImage first = engine.picture();
  engine.beginIsovalue(phantom->isovalue() - 300);
  while (!engine.gatherIsovalue(1000, 0)) {
  }
  engine.endIsovalue(engine.isovalue());
  engine.show(camera, {}, DrawOrder::kWhole);
  drawAll(engine);
  Engine other(volume, makePlan({.draws = true}), phantom->isovalue() - 300, "");
  EXPECT_EQ(differing(engine.picture(), other.draw(camera)), 0);
  EXPECT_GT(differing(engine.picture(), first), 100);
}

TEST(Picture, IsRefusedWhereThePlanDoesNotDraw) {
  const Volume volume = makeVolume(*makePhantom("phantom:sphere?size=24"));
  Engine engine(volume, makePlan({}), 0, "");
  EXPECT_THROW(engine.show(cameraTo(volume, 0.1), {}, DrawOrder::kWhole), Error);
  EXPECT_THROW(static_cast<void>(engine.picture()), Error);
  EXPECT_TRUE(engine.drawPiece(1e-3));  // there is nothing to draw
  EXPECT_TRUE(engine.pollPicture());
}

TEST(Picture, ThatWasRefusedIsNoPicture) {
  const Volume volume = makeVolume(*makePhantom("phantom:sphere?size=24"));
  Engine engine(volume, makePlan({.draws = true}), 0, "");
  Camera bad = cameraTo(volume, 0.1);
  bad.width = 0;
  EXPECT_THROW(engine.show(bad, {}, DrawOrder::kWhole), Error);
  EXPECT_THROW(static_cast<void>(engine.picture()), Error);
  std::vector<layout::PicturePixel> pixels;
  EXPECT_THROW(engine.copyPicture(pixels), Error);
  EXPECT_TRUE(engine.drawPiece(1e-3));
}

}  // namespace picture_test
}  // namespace palpate
