// SPDX-License-Identifier: Apache-2.0
// Frames of the live picture: which come, of which camera, and that the last one is the picture drawn anew.
#include "apps/rig/live_view.hpp"

#include <chrono>
#include <cmath>
#include <cstring>
#include <thread>

#include <gtest/gtest.h>

#include "engine/phantoms/phantom.hpp"
#include "engine/service/engine.hpp"

namespace palpate {
namespace live_view_test {

struct Scene {
  Volume volume = makeVolume(*makePhantom("phantom:sphere?size=40"));
  Engine engine{volume, makePlan({.edits = true, .other_isovalues = true, .draws = true}), 0, ""};
  LiveView view{0.02, 2e-4};
  std::int64_t now_ns = 0;

  ViewRequest from(double x, DrawOrder order = DrawOrder::kCoarseFirst) const {
    return {lookAt(Vec3::Zero(), Vec3(x, -1, 0.3).normalized(), 0.1, Vec3::UnitZ(), 150, 90, 0.6), {}, order};
  }
  // A look each millisecond until the newest frame is whole. Returns how many frames came.
  int settle() {
    const std::uint64_t before = view.latest().number;
    for (int i = 0; i < 100000; ++i) {
      now_ns += 1'000'000;
      if (!view.look(engine, now_ns) && i > 3) break;
      std::this_thread::sleep_for(std::chrono::microseconds(100));  // the device draws beside this thread
    }
    return static_cast<int>(view.latest().number - before);
  }
};

bool isPictureOf(Engine& engine, const ViewFrame& frame) {
  const RenderedImage anew = engine.draw(frame.camera);
  if (anew.distance_m.size() != frame.pixels.size()) return false;
  for (std::size_t i = 0; i < frame.pixels.size(); ++i) {
    if (std::memcmp(&frame.pixels[i].rgba, &anew.rgba[4 * i], 4) != 0) return false;
    if (frame.pixels[i].distance_m != anew.distance_m[i]) return false;
  }
  return true;
}

TEST(LiveView, ShowsNothingUntilItIsAsked) {
  Scene scene;
  EXPECT_FALSE(scene.view.look(scene.engine, 0));
  EXPECT_EQ(scene.view.latest().number, 0U);
}

TEST(LiveView, EndsWithTheWholePicture) {
  Scene scene;
  scene.view.show(scene.from(0));
  EXPECT_GE(scene.settle(), 1);
  const ViewFrame& frame = scene.view.latest();
  EXPECT_TRUE(frame.whole);
  EXPECT_EQ(frame.camera.width, 150);
  EXPECT_TRUE(isPictureOf(scene.engine, frame));
  EXPECT_EQ(scene.settle(), 0);  // and nothing comes after it
}

// A request for each look: cameras that move on all the time. Frames still come, each of one camera and coarse at
// least.
TEST(LiveView, ShowsSomethingOfACameraThatMoves) {
  Scene scene;
  scene.view.show(scene.from(0));
  scene.settle();
  std::uint64_t last = scene.view.latest().number;
  int frames = 0;
  for (int i = 1; i <= 20000 && frames < 5; ++i) {
    scene.view.show(scene.from(1e-3 * i));
    scene.now_ns += 1'000'000;
    scene.view.look(scene.engine, scene.now_ns);
    std::this_thread::sleep_for(std::chrono::microseconds(200));  // the device draws beside this thread
    const ViewFrame& frame = scene.view.latest();
    if (frame.number == last) continue;
    last = frame.number;
    ++frames;
    // Every eighth pixel is that of the frame's own camera; of a fast device every fourth.
    const RenderedImage anew = scene.engine.draw(frame.camera);
    for (std::size_t y = 0; y < 90; y += 8) {
      for (std::size_t x = 0; x < 150; x += 8)
        ASSERT_EQ(frame.pixels[y * 150 + x].distance_m, anew.distance_m[y * 150 + x]) << x << ' ' << y;
    }
  }
  EXPECT_EQ(frames, 5);
}

TEST(LiveView, FollowsEditsAndTellsTheirVersion) {
  Scene scene;
  scene.engine.allowEdits(brushProfile(scene.volume, 0));
  scene.view.show(scene.from(0));
  scene.settle();
  const std::vector<layout::PicturePixel> before = scene.view.latest().pixels;
  EXPECT_EQ(scene.view.latest().edit_version, 0U);
  EditCommand carve;
  carve.kind = EditKind::kRemove;
  carve.from_W = carve.to_W =
      scene.engine.draw(scene.from(0).camera).distance_m[45 * 150 + 75] * scene.from(0).camera.forward_W +
      scene.from(0).camera.position_W;
  carve.radius_m = 4e-3;
  scene.engine.edit(std::span(&carve, 1), 0);
  EXPECT_GE(scene.settle(), 1);
  const ViewFrame& frame = scene.view.latest();
  EXPECT_EQ(frame.edit_version, 1U);
  EXPECT_TRUE(isPictureOf(scene.engine, frame));
  EXPECT_GT(frame.pixels[45 * 150 + 75].distance_m, before[45 * 150 + 75].distance_m + 3e-3F);  // the pit is 4 mm deep
  EXPECT_EQ(frame.pixels[0].distance_m, before[0].distance_m);
}

TEST(LiveView, FollowsTheIsovalueThatIsFelt) {
  Scene scene;
  scene.view.show(scene.from(0));
  scene.settle();
  const float before = scene.view.latest().pixels[45 * 150 + 75].distance_m;
  scene.engine.beginIsovalue(-300);
  while (!scene.engine.gatherIsovalue(1000, 0)) {
  }
  scene.engine.endIsovalue(scene.engine.isovalue());
  EXPECT_GE(scene.settle(), 1);
  EXPECT_LT(scene.view.latest().pixels[45 * 150 + 75].distance_m, before);  // less dense is farther out
  EXPECT_TRUE(isPictureOf(scene.engine, scene.view.latest()));
}

// A picture that cannot be drawn ends the drawing, is told, and the next request is tried again.
TEST(LiveView, TellsAFailureAndGoesOn) {
  Scene scene;
  ViewRequest bad = scene.from(0);
  bad.camera.width = 0;
  scene.view.show(bad);
  EXPECT_FALSE(scene.view.look(scene.engine, 0));
  EXPECT_NE(scene.view.failure().find("0 x 90 pixels"), std::string::npos) << scene.view.failure();
  scene.view.show(scene.from(0));
  EXPECT_GE(scene.settle(), 1);
  EXPECT_TRUE(scene.view.latest().whole);
}

// A request that is refused leaves the picture that is shown, and edits still come into it.
TEST(LiveView, ARefusedRequestLeavesThePictureAlive) {
  Scene scene;
  scene.engine.allowEdits(brushProfile(scene.volume, 0));
  scene.view.show(scene.from(0));
  scene.settle();
  ViewRequest bad = scene.from(0.01);
  bad.style.slices = {{Vec3::UnitX(), 0}};
  bad.style.slice_white = bad.style.slice_black;
  scene.view.show(bad);
  scene.settle();
  EXPECT_NE(scene.view.failure(), "");
  const Camera& camera = scene.view.latest().camera;
  EXPECT_EQ(camera, scene.from(0).camera);
  EditCommand carve;
  carve.kind = EditKind::kRemove;
  carve.from_W = carve.to_W =
      camera.position_W + scene.engine.draw(camera).distance_m[45 * 150 + 75] * camera.forward_W;
  carve.radius_m = 4e-3;
  scene.engine.edit(std::span(&carve, 1), 0);
  EXPECT_GE(scene.settle(), 1);
  EXPECT_EQ(scene.view.latest().edit_version, 1U);
  EXPECT_TRUE(isPictureOf(scene.engine, scene.view.latest()));
  EXPECT_NE(scene.view.failure(), "");  // until the next request
  scene.view.show(scene.from(0.01));
  EXPECT_GE(scene.settle(), 1);
  EXPECT_EQ(scene.view.failure(), "");
  EXPECT_EQ(scene.view.latest().camera, scene.from(0.01).camera);
}

}  // namespace live_view_test
}  // namespace palpate
