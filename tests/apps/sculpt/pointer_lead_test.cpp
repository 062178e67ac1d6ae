// SPDX-License-Identifier: Apache-2.0
// A person who presses view keys, turns, zooms and jumps with the pointer at random, before bodies whose surfaces are
// known exactly. The servo is a path that is led by the aims, in millisecond steps. Pictures are of rays to the exact
// surface, and come some frames late.
#include "apps/sculpt/pointer_lead.hpp"

#include <cmath>
#include <deque>
#include <functional>
#include <limits>
#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/phantoms/phantom.hpp"
#include "engine/session/tool_brush.hpp"
#include "tests/apps/sculpt/still_side.hpp"
#include "tests/servo/support/seeded.hpp"

namespace palpate {
namespace pointer_lead_test {

using Surface = std::function<double(const Vec3&)>;  // signed distance, negative inside [m]

// What a window sees of a body, and where the tool is.
class Scene final : public StillSide {
 public:
  Scene(Surface surface, SeenExtent object)
      : surface_(std::move(surface)), path_(Vec3(object.middle_W - Vec3(0, 0.5, 0))) {
    volume_.object = std::move(object);
    path_.follow(aims_);
    tick_.tick = 0;
    step(0);
  }

  void show(const ViewRequest& wanted) override {
    if (!wanted_.empty() && wanted_.back() == wanted.camera) return;
    wanted_.push_back(wanted.camera);
  }
  void aim(const PointerTarget& target) noexcept override {
    leaps += target.from_W ? 1 : 0;
    aimed_W = target.hip_W;
    aim_.aim(target);
  }
  void press(const ToolBrushSpec& brush) override { brush_.emplace(brush, Vec3i::Constant(1000), Lattice{}); }
  void release() override { brush_.reset(); }

  // The picture that was asked for so many frames ago.
  void draw(std::size_t late) {
    while (wanted_.size() > 1 + late) wanted_.pop_front();
    if (wanted_.empty() || (frame_.number > 0 && frame_.camera == wanted_.front())) return;
    frame_.camera = wanted_.front();
    ++frame_.number;
    frame_.pixels.clear();
    for (int y = 0; y < frame_.camera.height; ++y) {
      for (int x = 0; x < frame_.camera.width; ++x) frame_.pixels.push_back({0, distanceAt(x + 0.5, y + 0.5)});
    }
  }

  // Milliseconds of the servo; the engine looks at the tool once in `looks`.
  void step(int milliseconds, int looks = 1) {
    for (int i = 0; i < milliseconds; ++i) {
      const auto before = path_.leaps();
      const Vec3 hip_W = path_.position(static_cast<double>(++tick_.tick) * 1e-3);
      for (int axis = 0; axis < 3; ++axis) tick_.hip_W[axis] = hip_W[axis];
      const double depth_m = -surface_(hip_W);
      deepest_m = std::max(deepest_m, depth_m);
      if (path_.leaps() != before) shallowest_leap_m = std::min(shallowest_leap_m, -depth_m);
      touched += depth_m > 0 ? 1 : 0;
      if (!brush_ || tick_.tick % looks != 0) continue;
      ToolPose pose;
      pose.position_W = hip_W;
      if (depth_m > 0) pose.normal_W = Vec3::UnitZ();
      pose.force_W = pose.normal_W;
      pose.leaps = static_cast<std::uint32_t>(path_.leaps());
      for (const EditCommand& edit : brush_->dueStroke(pose, tick_.tick * 1'000'000)) {
        ++edits;
        for (int k = 0; k <= 32; ++k)
          deepest_edit_m = std::max(deepest_edit_m, -surface_(edit.from_W + k / 32.0 * (edit.to_W - edit.from_W)));
      }
    }
  }

  double deepest_m = 0, deepest_edit_m = 0, shallowest_leap_m = 1;
  int edits = 0, leaps = 0, touched = 0;
  Vec3 aimed_W = Vec3::Zero();

 private:
  [[nodiscard]] float distanceAt(double x, double y) const {
    const Vec3 ray_W = frame_.camera.rayThrough(x, y);
    double distance_m = 0;
    for (int step = 0; step < 100 && distance_m < 2; ++step) {
      const double next_m = surface_(frame_.camera.position_W + distance_m * ray_W);
      if (next_m < 2e-6) return static_cast<float>(distance_m);
      distance_m += next_m;
    }
    return std::numeric_limits<float>::infinity();
  }

  Surface surface_;
  std::deque<Camera> wanted_;
  PointerAimBlock aims_;
  PointerAim aim_{aims_};
  PointerPath path_;
  std::optional<ToolBrush> brush_;
};

// A window on it: of two that take turns each has its own view.
struct Person {
  Person(const SeenExtent& object, int width, int height) : view(object, width, height), lead(view.distance_m()) {
    input.over = true;
    input.x = width / 2.0;
    input.y = height / 2.0;
  }
  void frame(Scene& scene) {
    const ToolRequest request = gestures.take(input, scene.frame(), view, brush, reach);
    lead.lead(scene, request, gestures.kind(), input, reach, scene.tick());
    scene.show({view.camera(), {}, DrawOrder::kWhole});
    input.view_key.reset();
    input.wheel = input.dx = input.dy = 0;
  }

  // A second of frames, each of which is drawn at once.
  void lookOn(Scene& scene) {
    for (int i = 0; i < 60; ++i) {
      frame(scene);
      scene.draw(0);
      scene.step(16);
    }
  }

  OrbitView view;
  PointerLead lead;
  Gestures gestures;
  BrushChoice brush;
  PointerReach reach;
  PointerInput input;
  int zoomed = 0;  // steps
};

struct Body {
  Surface surface;
  SeenExtent object;
};

Body ball(double radius_m) {
  Body body{[=](const Vec3& p_W) { return p_W.norm() - radius_m; }, {}};
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) body.object.points_W.push_back(sign * radius_m * Vec3::Unit(axis));
  return body;
}

Body head() {
  const std::shared_ptr<const Phantom> phantom = makePhantom("phantom:head?size=128");
  Body body{[phantom](const Vec3& p_W) { return phantom->signedDistance_m(p_W); }, {}};
  // Some hundred points of it.
  for (Vec3i at(0, 0, 0); at.z() < 128; at = at.x() < 120   ? Vec3i(at + 8 * Vec3i::UnitX())
                                             : at.y() < 120 ? Vec3i(0, at.y() + 8, at.z())
                                                            : Vec3i(0, 0, at.z() + 8)) {
    const Vec3 p_W = phantom->lattice().toWorld(at.cast<double>());
    if (body.surface(p_W) < 0) body.object.points_W.push_back(p_W);
  }
  for (const Vec3& p_W : body.object.points_W)
    body.object.middle_W += p_W / static_cast<double>(body.object.points_W.size());
  return body;
}

// What a person may do between two frames.
void act(Seeded& random, Person& person, int width, int height) {
  PointerInput& in = person.input;
  const double x = in.x, y = in.y;
  switch (random.pick(16)) {
    case 0:
      in.view_key = static_cast<ViewKey>(random.pick(7));
      break;
    case 1:  // anywhere at once
      in.x = random.between(0, width);
      in.y = random.between(0, height);
      break;
    case 2:
      in.left = !in.left;
      break;
    case 3:  // begins or ends to turn
      in.right = !in.right;
      break;
    case 4:
      in.wheel = person.zoomed > 1 ? -1 : person.zoomed < -1 ? 1 : random.pick(2) == 0 ? 1 : -1;  // pixels stay small
      person.zoomed += static_cast<int>(in.wheel);
      break;
    case 5:  // leaves, or comes back elsewhere
      in.over = !in.over;
      in.x = random.between(0, width);
      break;
    case 6:
      person.view.resize(width - random.pick(20), height - random.pick(20));
      break;
    default:
      in.x = std::clamp(in.x + random.between(-6, 6), 0.0, width - 1.0);
      in.y = std::clamp(in.y + random.between(-6, 6), 0.0, height - 1.0);
  }
  in.dx = in.x - x;
  in.dy = in.y - y;
}

// How deep the tool may be: twice the reach (PointerTool::kDeepest) along the ray of a pixel, or of a neighbour of it,
// whose middle lies two diagonals of a pixel aside at most. And what the led path overshoots when it is turned at its
// full speed: v t exp(-t / T) is v T / e at most.
double deepestAllowed(double pixel_m, double reach_m) {
  constexpr double kOvershoot_m = PointerPath::kFastest_m_per_s * PointerPath::kTimeConstant_s / 2.718281828;
  return PointerTool::kDeepest * reach_m + 2 * std::sqrt(2.0) * pixel_m + kOvershoot_m;
}

struct Outcome {
  double deepest_m = 0, deepest_edit_m = 0, shallowest_leap_m = 0, allowed_m = 0;
  int edits = 0, leaps = 0;
};

Outcome play(const Body& body, unsigned seed, int frames, int windows, int width) {
  const int height = 3 * width / 4;
  Seeded random(seed);
  Scene scene(body.surface, body.object);
  std::vector<Person> people;
  for (int i = 0; i < windows; ++i) people.emplace_back(body.object, width, height);
  std::size_t who = 0;
  double allowed_m = 0;
  for (int i = 0; i < frames; ++i) {
    if (windows > 1 && random.pick(20) == 0) {
      people[who].input.left = people[who].input.right = false;
      people[who].frame(scene);
      who = 1 - who;
    }
    Person& person = people[who];
    act(random, person, width, height);
    // Two windows have pictures of their own: this one's comes at once.
    scene.draw(windows > 1 ? 0 : static_cast<std::size_t>(random.pick(4)));
    if (windows > 1) {
      scene.show({person.view.camera(), {}, DrawOrder::kWhole});
      scene.draw(0);
    }
    person.frame(scene);
    const Camera& camera = scene.frame().camera;
    double far_m = 0;
    for (const Vec3& p_W : body.object.points_W) far_m = std::max(far_m, (p_W - camera.position_W).norm());
    allowed_m = std::max(allowed_m, deepestAllowed(camera.pixelSize(far_m), person.reach.depth_m));
    scene.step(3 + random.pick(30), 1 + random.pick(40));
    EXPECT_LE(scene.deepest_m, allowed_m) << "seed " << seed << ", frame " << i;
    if (scene.deepest_m > allowed_m) break;
  }
  return {scene.deepest_m, scene.deepest_edit_m, scene.shallowest_leap_m, allowed_m, scene.edits, scene.leaps};
}

void expectKept(const Body& body, unsigned seeds, int frames, int windows, int width) {
  Outcome all{.shallowest_leap_m = 1};
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    const Outcome one = play(body, seed, frames, windows, width);
    EXPECT_LE(one.deepest_edit_m, one.allowed_m) << "seed " << seed;
    EXPECT_GT(one.shallowest_leap_m, 0) << "seed " << seed;  // the tool comes down from outside
    all.deepest_m = std::max(all.deepest_m, one.deepest_m);
    all.deepest_edit_m = std::max(all.deepest_edit_m, one.deepest_edit_m);
    all.edits += one.edits;
    all.leaps += one.leaps;
  }
  EXPECT_GT(all.edits, 3);
  EXPECT_GT(all.leaps, 20);
  testing::Test::RecordProperty("deepest_um", static_cast<int>(1e6 * all.deepest_m));
}

TEST(PointerLead, NeverDragsTheToolThroughABall) {
  expectKept(ball(0.04), 8, 400, 1, 100);
}

TEST(PointerLead, NeverDragsTheToolThroughAHead) {
  expectKept(head(), 3, 250, 1, 64);
}

TEST(PointerLead, TwoWindowsTakeTurns) {
  expectKept(ball(0.04), 6, 200, 2, 100);
}

// Each of the keys from each side, with the pointer in the middle: the tool is then on the other side, and outside, and
// never was in the ball.
TEST(PointerLead, ViewKeysLiftTheTool) {
  const Body body = ball(0.04);
  for (const bool presses : {false, true}) {
    Scene scene(body.surface, body.object);
    Person person(body.object, 160, 120);
    person.input.left = presses;
    for (const ViewKey key : {ViewKey::kFront, ViewKey::kBack, ViewKey::kRight, ViewKey::kLeft, ViewKey::kTop,
                              ViewKey::kBottom, ViewKey::kFront, ViewKey::kTop, ViewKey::kRight, ViewKey::kBack}) {
      person.input.view_key = key;
      person.lookOn(scene);
      const Vec3 hip_W = asVec3(scene.tick().hip_W);
      const Vec3 seen_from_W = person.view.camera().position_W.normalized();
      EXPECT_GT(hip_W.normalized().dot(seen_from_W), 0.999);
      // Pressed by the reach, or hovering: to the half of a per mille that the path has still to go after a second, and
      // to what the pixel under the pointer is off, which lies a ball's sag of half a diagonal below its middle.
      EXPECT_NEAR(hip_W.norm() - 0.04, presses ? -person.reach.depth_m : person.reach.lift_m, 1e-4);
    }
    EXPECT_LE(scene.deepest_m, presses ? 1.1 * person.reach.depth_m : 0);
  }
}

// What is not drawn presses the tool no harder than what is: a tool that is deeper than PointerTool::kDeepest times the
// reach is led back to the reach. A brush that adds may put its radius over the tool, from the stroke's begin to its
// end.
TEST(PointerLead, LeadsTheToolOutOfWhatIsNotDrawnButNotOutOfWhatItAdds) {
  const Body body = ball(0.04);
  Scene scene(body.surface, body.object);
  Person person(body.object, 160, 120);
  person.lookOn(scene);
  const Vec3 normal_W = person.view.camera().position_W.normalized();
  const double reach_m = person.reach.depth_m, radius_m = 3e-3;
  TickRecord tick = scene.tick();
  const auto aimAt = [&](const ToolRequest& request) {
    person.lead.lead(scene, request, Gestures::Kind::kStroke, person.input, person.reach, tick);
    return scene.aimed_W;
  };
  tick.in_contact = false;
  const Vec3 drawn_W = aimAt({.presses = true});
  tick.in_contact = true;
  for (int axis = 0; axis < 3; ++axis) tick.normal_W[axis] = normal_W[axis];
  const auto ledBackWith = [&](double depth_m, const ToolRequest& request) {
    for (int axis = 0; axis < 3; ++axis) tick.vhip_W[axis] = drawn_W[axis] + depth_m * normal_W[axis];
    return normal_W.dot(aimAt(request) - drawn_W);
  };
  const double deepest_m = PointerTool::kDeepest * reach_m, deep_m = deepest_m + 0.9 * radius_m;
  const ToolRequest holds{.presses = true};
  EXPECT_NEAR(ledBackWith(0.99 * deepest_m, holds), 0, 1e-9);
  EXPECT_NEAR(ledBackWith(1.01 * deepest_m, holds), 1.01 * deepest_m - reach_m, 1e-9);
  for (const EditKind kind : {EditKind::kAdd, EditKind::kRemove, EditKind::kDeflate}) {
    const bool adds = kind == EditKind::kAdd;
    ToolBrushSpec brush;
    brush.brush.kind = kind;
    brush.brush.radius_m = radius_m;
    static_cast<void>(ledBackWith(0, {.presses = true, .begins = brush}));
    EXPECT_NEAR(ledBackWith(deep_m, holds), adds ? 0 : deep_m - reach_m, 1e-9);
    EXPECT_NEAR(ledBackWith(deep_m + 0.2 * radius_m, holds), deep_m + 0.2 * radius_m - reach_m, 1e-9);
    static_cast<void>(ledBackWith(0, {.presses = true, .ends = true}));
    EXPECT_NEAR(ledBackWith(deep_m, holds), deep_m - reach_m, 1e-9);
  }
}

// As slow as 0.1 m/s: 1.6 mm a frame. The brush is not interrupted.
TEST(PointerLead, AStrokeOverASurfaceDoesNotLeap) {
  for (const Body& body : {ball(0.04), head()}) {
    Scene scene(body.surface, body.object);
    Person person(body.object, 160, 120);
    person.lookOn(scene);
    const int before = scene.leaps;
    person.input.left = true;
    const double pixel_m =
        scene.frame().camera.pixelSize((person.view.camera().position_W - body.object.middle_W).norm());
    for (int i = 0; i < 120; ++i) {
      person.input.x = 80 + 12 * std::sin(i / 20.0);
      person.input.y = 60 + std::min(12.0, i * 1.6e-3 / pixel_m);
      person.frame(scene);
      scene.step(16);
    }
    EXPECT_EQ(scene.leaps, before);
    EXPECT_GT(scene.edits, 100);
    EXPECT_GT(scene.touched, 1500);
  }
}

}  // namespace pointer_lead_test
}  // namespace palpate
