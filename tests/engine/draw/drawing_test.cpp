// SPDX-License-Identifier: Apache-2.0
// The picture's depth against small steps along each ray, and against formulas; slices, shading and refusals.
#include "engine/draw/drawing.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gmock/gmock.h>

#include "base/error.hpp"
#include "engine/reference/isosurface.hpp"
#include "tests/engine/passes/test_fields.hpp"

namespace palpate {
namespace drawing_test {

// A drawing of a volume, and what it needs.
class OfVolume {
 public:
  explicit OfVolume(const Volume& volume) : pool_(device_, transfer_, volume) { bounds_.run(); }

 private:
  gpu::Gpu device_{{}};
  gpu::Transfer transfer_{device_};
  BrickPool pool_;
  BrickBoundsPass bounds_{device_, pool_};

 public:
  Drawing drawing{device_, transfer_, pool_, bounds_};
};

RenderedImage drawFrom(const Volume& volume, const Camera& camera, double isovalue,
                       const std::function<void()>& between = {}) {
  OfVolume of(volume);
  of.drawing.show(camera, isovalue);
  of.drawing.finish(between);
  return of.drawing.image();
}

Vec3 middleOf(const Volume& volume) {
  return volume.lattice().toWorld((volume.size().cast<double>().array() - 1) / 2);
}

Camera cameraAt(const Vec3& eye_W, const Vec3& target_W) {
  Camera camera;
  camera.position_W = eye_W;
  camera.forward_W = (target_W - eye_W).normalized();
  camera.right_W = camera.forward_W.cross(Vec3::UnitZ()).normalized();
  camera.up_W = camera.right_W.cross(camera.forward_W);
  camera.vertical_fov_rad = 0.35;
  camera.width = 61;
  camera.height = 47;
  return camera;
}

bool isBackground(const RenderedImage& image, std::size_t pixel) {
  std::uint32_t rgba = 0;
  std::memcpy(&rgba, &image.rgba[4 * pixel], 4);
  return rgba == PICTURE_BACKGROUND;
}

struct Compared {
  int hits = 0, differing = 0;
  std::vector<double> errors_voxel;
};

// Each pixel against small steps along its own ray. The search for a root leaves at worst 1.2e-3 of the way through a
// cell (draw.layout.h), so 2e-3 voxel; a float position at some 200 voxels adds 2e-5. What is thinner than a step of
// the other method may be seen by one alone.
Compared compare(const Volume& volume, const Camera& camera, const RenderedImage& image, double isovalue = 0,
                 const std::vector<ViewPlane>& clips = {}, double step_voxels = 0.05) {
  const reference::DenseField field = reference::denseField(volume);
  const auto kept = [&](const Vec3& p_W) {
    return std::ranges::all_of(clips, [&](const ViewPlane& clip) { return clip.normal_W.dot(p_W) >= clip.offset_m; });
  };
  Compared compared;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const auto expected = reference::firstHit(field, isovalue, camera.position_W, camera.rayThrough(x + 0.5, y + 0.5),
                                                step_voxels, kept);
      const std::size_t pixel =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(camera.width) + static_cast<std::size_t>(x);
      const bool hit = std::isfinite(image.distance_m[pixel]);
      EXPECT_EQ(image.rgba[4 * pixel + 3], hit ? 255U : 0U);
      const double error_voxel =
          hit && expected ? std::abs(image.distance_m[pixel] - *expected) / volume.lattice().spacing_m.maxCoeff() : 0;
      compared.differing += hit != expected.has_value() || error_voxel > 2e-3;
      compared.hits += hit;
      if (hit && expected) compared.errors_voxel.push_back(error_voxel);
    }
  }
  return compared;
}

TEST(Drawing, DepthIsThatOfSmallSteps) {
  const Volume volume = ballField({53, 41, 37}, 14.0);
  const Camera camera = cameraAt(middleOf(volume) + Vec3(0.05, -0.09, 0.04), middleOf(volume));
  Compared compared = compare(volume, camera, drawFrom(volume, camera, 0.0));
  EXPECT_GT(compared.hits, 300);
  EXPECT_LE(compared.differing, 2);  // of the silhouette
  std::ranges::sort(compared.errors_voxel);
  EXPECT_LT(compared.errors_voxel[compared.errors_voxel.size() / 2], 5e-5);
}

Mat3 anyRotation(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  Mat3 R = Eigen::Quaterniond(unit(random), unit(random), unit(random), unit(random)).normalized().toRotationMatrix();
  if (random() % 2 == 0) R.col(0) *= -1;  // left-handed
  return R;
}

// Noise of few different values (so that many corners lie at the isovalue) and balls, on lattices that are turned, flat
// and left-handed, of all small sizes, from outside and from within, with clipping planes anywhere.
TEST(Drawing, DepthIsThatOfSmallStepsOnAnyLattice) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> unit(0, 1);
  gpu::Gpu gpu({});
  gpu::Transfer transfer(gpu);
  int hits = 0, differing = 0, clipped = 0;
  for (int trial = 0; trial < 24; ++trial) {
    const auto edge = [&] { return 2 + static_cast<int>(random() % (trial % 3 == 0 ? 4 : 30)); };
    const Vec3i size(edge(), edge(), edge());
    Lattice lattice;
    lattice.R_WL = anyRotation(random);
    lattice.origin_W = Vec3(unit(random), unit(random), unit(random)) * 0.1;
    lattice.spacing_m = Vec3(unit(random) + 0.1, unit(random) + 0.1, unit(random) + 0.1) * 1e-3;
    std::vector<float> values;
    for (int n = 0; n < size.prod(); ++n) {
      const Vec3 p(n % size.x(), n / size.x() % size.y(), n / (size.x() * size.y()));
      const double ball = 0.35 * size.maxCoeff() - (p - (size.cast<double>() - Vec3::Ones()) / 2).norm();
      values.push_back(trial % 2 == 0 ? static_cast<float>(ball)
                                      : static_cast<float>(static_cast<int>(random() % 4) - 2));
    }
    const Volume volume = Volume::fromDense(size, lattice, values, {});
    const Vec3 extent = size.cast<double>().cwiseProduct(lattice.spacing_m);
    const Vec3 middle_W = middleOf(volume);
    const double away = trial % 4 == 3 ? 0.2 : 2.0;  // within, and outside
    const Vec3 eye_W = middle_W + away * extent.norm() * anyRotation(random).col(1);
    Camera camera = cameraAt(eye_W, middle_W + 0.1 * extent.norm() * Vec3(unit(random), unit(random), unit(random)));
    camera.width = 23;
    camera.height = 19;
    camera.vertical_fov_rad = 0.6;
    DrawStyle style;
    for (unsigned n = 0; n < random() % 3; ++n) {
      const Vec3 normal_W = anyRotation(random).col(2);
      style.clips.push_back({3 * normal_W, 3 * normal_W.dot(middle_W) + 0.3 * extent.norm() * (unit(random) - 0.5)});
    }
    const BrickPool pool(gpu, transfer, volume);
    BrickBoundsPass bounds(gpu, pool);
    bounds.run();
    Drawing drawing(gpu, transfer, pool, bounds);
    const double isovalue = trial % 2 == 0 ? 0.0 : 0.25 * (static_cast<double>(random() % 9) - 4);
    drawing.show(camera, isovalue, style);
    drawing.finish();
    const Compared compared = compare(volume, camera, drawing.image(), isovalue, style.clips, 0.02);
    hits += compared.hits;
    differing += compared.differing;
    clipped += style.clips.empty() ? 0 : compared.hits;
    EXPECT_LE(compared.differing, 4) << "trial " << trial << " size " << size.transpose();  // slivers at silhouettes
  }
  EXPECT_GT(hits, 1000);
  EXPECT_GT(clipped, 500);
  EXPECT_LE(differing, hits / 200);
}

// Of a picture that a slow device needs long for every eighth pixel comes first, of a small one every fourth.
TEST(Drawing, BeginsTheCoarserTheLongerItTakes) {
  const Volume volume = ballField({53, 41, 37}, 14.0);
  Camera camera = cameraAt(middleOf(volume) + Vec3(0.05, -0.09, 0.04), middleOf(volume));
  const auto isOfSquares = [&](int width, int height, int side) {
    camera.width = width;
    camera.height = height;
    OfVolume of(volume);  // which has measured no tile yet, and thinks of a processor
    of.drawing.show(camera, 0, {}, DrawOrder::kCoarseFirst);
    while (!of.drawing.state().showable) {
      static_cast<void>(of.drawing.advance(1));
      of.drawing.wait();
    }
    const RenderedImage image = of.drawing.image();
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const auto at = [&](int a, int b) { return image.distance_m[static_cast<std::size_t>(b * width + a)]; };
        if (at(x, y) != at(x / side * side, y / side * side)) return false;
      }
    }
    return true;
  };
  EXPECT_TRUE(isOfSquares(960, 720, 8));
  EXPECT_TRUE(isOfSquares(120, 96, 4));
  EXPECT_FALSE(isOfSquares(120, 96, 8));
}

// Tile by tile or in one piece.
TEST(Drawing, IsTheSameInPiecesOfAnySize) {
  const Volume volume = ballField({53, 41, 37}, 14.0);
  Camera camera = cameraAt(middleOf(volume) + Vec3(0.05, -0.09, 0.04), middleOf(volume));
  camera.width = 90;
  camera.height = 150;
  OfVolume of(volume);
  Drawing& drawing = of.drawing;
  drawing.show(camera, 0);
  int pieces = 0;
  for (double share = -1; !drawing.advance(1e-12); drawing.wait()) {  // one tile a piece
    ++pieces;
    EXPECT_GE(drawing.share(), share);
    share = drawing.share();
  }
  EXPECT_EQ(pieces, 12 * 19);
  EXPECT_EQ(drawing.share(), 1);
  const RenderedImage by_tiles = drawing.image();
  drawing.show(camera, 0);
  while (!drawing.advance(10)) drawing.wait();
  EXPECT_EQ(drawing.image().rgba, by_tiles.rgba);
  EXPECT_EQ(drawing.image().distance_m, by_tiles.distance_m);
}

TEST(Drawing, CanBeEndedBetweenPieces) {
  const Volume volume = ballField({24, 24, 24}, 6.0);
  const Camera camera = cameraAt(middleOf(volume) + Vec3(0.08, 0, 0), middleOf(volume));
  EXPECT_THROW((void)drawFrom(volume, camera, 0, [] { throw std::runtime_error("enough"); }), std::runtime_error);
}

// What is refused leaves the picture as it was, or none.
TEST(Drawing, GoesOnWithTheLastPictureAfterARefusal) {
  const Volume volume = ballField({24, 24, 24}, 6.0);
  const Camera camera = cameraAt(middleOf(volume) + Vec3(0.08, 0, 0), middleOf(volume));
  OfVolume of(volume);
  Drawing& drawing = of.drawing;
  const auto refused = [&](const Camera& bad, const DrawStyle& style = {}) {
    try {
      drawing.show(bad, 0, style);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  using testing::HasSubstr;
  const auto with = [&](auto change) {
    Camera changed = camera;
    change(changed);
    return changed;
  };
  EXPECT_FALSE(drawing.shows());
  EXPECT_THAT(refused(with([](Camera& c) { c.width = 0; })), HasSubstr("0 x 47 pixels"));
  EXPECT_FALSE(drawing.shows());
  drawing.show(camera, 0);
  drawing.finish();
  const RenderedImage before = drawing.image();
  EXPECT_THAT(refused(with([](Camera& c) { c.width = 16385; })), HasSubstr("16385 x 47 pixels"));
  EXPECT_THAT(refused(with([](Camera& c) { c.width = 16384, c.height = 1025; })), HasSubstr("at most 16777216 in all"));
  EXPECT_THAT(refused(with([](Camera& c) { c.position_W.x() = NAN; })), HasSubstr("not finite"));
  EXPECT_THAT(refused(with([](Camera& c) { c.vertical_fov_rad = 3.2; })), HasSubstr("angle of view"));
  EXPECT_THAT(refused(with([](Camera& c) { c.position_W.x() += 1000; })), HasSubstr("voxels away"));  // of 0.7 mm
  DrawStyle style;
  style.clips.assign(7, {});
  EXPECT_THAT(refused(camera, style), HasSubstr("give at most 6"));
  style = {};
  style.slices.assign(4, {});
  EXPECT_THAT(refused(camera, style), HasSubstr("give at most 3"));
  style = {};
  style.clips = {{Vec3::Zero(), 0}};
  EXPECT_THAT(refused(camera, style), HasSubstr("normal is zero"));
  style = {};
  style.slice_white = style.slice_black;
  EXPECT_THAT(refused(camera, style), HasSubstr("equal or not finite"));
  style = {};
  style.other_isovalue = NAN;
  EXPECT_THAT(refused(camera, style), HasSubstr("second isovalue"));
  style = {};
  style.other_opacity = 1.1;
  EXPECT_THAT(refused(camera, style), HasSubstr("opacity"));
  EXPECT_TRUE(drawing.whole());
  EXPECT_EQ(drawing.image().rgba, before.rgba);
  EXPECT_EQ(drawing.image().distance_m, before.distance_m);
}

// Where a clipping plane cuts the object and a slice lies in the same plane, the slice shows the density; with either
// normal, and with planes through voxels that end the volume.
TEST(Drawing, ASliceIsSeenOnTheCutInItsPlane) {
  const Volume volume = ballField({41, 41, 41}, 14.0);
  const Vec3 middle_W = middleOf(volume);
  const Camera camera = cameraAt(middle_W + Vec3(0.05, -0.09, 0.04), middle_W);
  OfVolume of(volume);
  Drawing& drawing = of.drawing;
  DrawStyle style;
  style.slice_black = -3;
  style.slice_white = 3;
  const std::size_t in_middle = std::size_t{23} * 61 + 30;
  for (const double side : {1.0, -1.0}) {
    style.clips = {{Vec3(0, 1, 0), middle_W.y()}};
    style.slices = {{Vec3(0, side, 0), side * middle_W.y()}};
    drawing.show(camera, 0, style);
    drawing.finish();
    const RenderedImage image = drawing.image();
    EXPECT_GE(image.rgba[4 * in_middle], 254U);  // the density is 3 in the middle of the ball
    EXPECT_EQ(image.rgba[4 * in_middle], image.rgba[4 * in_middle + 2]);
  }
  style.clips.clear();
  for (const int voxel : {0, 40}) {
    const double y_m = volume.lattice().toWorld(Vec3(0, voxel, 0)).y();
    style.slices = {{Vec3(0, 1, 0), y_m}};
    drawing.show(camera, 100, style);  // no surface
    drawing.finish();
    const RenderedImage image = drawing.image();
    int shown = 0, beside = 0;
    for (int y = 0; y < camera.height; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        const Vec3 ray_W = camera.rayThrough(x + 0.5, y + 0.5);
        const double t_m = (y_m - camera.position_W.y()) / ray_W.y();
        const Vec3 p_L = volume.lattice().toIndex(camera.position_W + t_m * ray_W);
        const bool is_in = p_L.x() > 0.02 && p_L.x() < 39.98 && p_L.z() > 0.02 && p_L.z() < 39.98;
        const double drawn_m = image.distance_m[static_cast<std::size_t>(y) * camera.width + x];
        if (!is_in) {  // at the rim, a pixel may be of the slice
          beside += isBackground(image, static_cast<std::size_t>(y) * camera.width + x) && std::isinf(drawn_m);
          continue;
        }
        ++shown;
        EXPECT_NEAR(drawn_m, t_m, 1e-6) << x << ' ' << y << " voxel " << voxel;
      }
    }
    EXPECT_GT(shown, 100);
    EXPECT_GE(shown + beside, 0.98 * camera.width * camera.height);
  }
}

// Beside the first surface a second one is before the background, and everywhere as opaque as it is said to be.
TEST(Drawing, ASecondSurfaceIsSeenThrough) {
  const Volume volume = ballField({41, 41, 41}, 12.0);
  const Vec3 middle_W = middleOf(volume);
  const Camera camera = cameraAt(middle_W + Vec3(0.05, -0.09, 0.04), middle_W);
  OfVolume of(volume);
  DrawStyle style;
  style.other_isovalue = -2;  // two voxels outside the first
  std::vector<RenderedImage> images;
  for (const double opacity : {0.0, 0.5, 1.0}) {
    style.other_opacity = opacity;
    of.drawing.show(camera, 0, style);
    of.drawing.finish();
    images.push_back(of.drawing.image());
  }
  int rim = 0, beside = 0, before = 0;
  for (std::size_t pixel = 0; pixel < images[0].distance_m.size(); ++pixel) {
    const int width = camera.width;
    const Vec3 ray_W = camera.rayThrough(static_cast<double>(pixel % static_cast<std::size_t>(width)) + 0.5,
                                         static_cast<double>(pixel / static_cast<std::size_t>(width)) + 0.5);
    const Vec3 eye = volume.lattice().toIndex(camera.position_W);
    const Vec3 along = (volume.lattice().toIndex(camera.position_W + 1e-3 * ray_W) - eye).normalized();
    const double passes_voxel = (Vec3::Constant(20) - eye).cross(along).norm();
    EXPECT_EQ(std::isfinite(images[1].distance_m[pixel]), std::isfinite(images[0].distance_m[pixel]));
    if (passes_voxel > 15) {
      for (const RenderedImage& image : images) EXPECT_TRUE(isBackground(image, pixel));
      ++beside;
      continue;
    }
    if (passes_voxel > 12.2 && passes_voxel < 13.8) {
      EXPECT_TRUE(isBackground(images[0], pixel));
      EXPECT_FALSE(isBackground(images[1], pixel));
      EXPECT_TRUE(std::isinf(images[1].distance_m[pixel]));
      ++rim;
    }
    if (passes_voxel > 13.8) continue;
    before += passes_voxel < 11;
    for (std::size_t i = 4 * pixel; i < 4 * pixel + 3; ++i)  // each of the three is rounded, the middle one twice
      EXPECT_NEAR(images[1].rgba[i], (images[0].rgba[i] + images[2].rgba[i]) / 2.0, 1.5) << pixel;
  }
  EXPECT_GT(rim, 50);
  EXPECT_GT(beside, 50);
  EXPECT_GT(before, 50);
}

// The shape is seen alike whatever the unit of the densities.
TEST(Drawing, ShadesDensitiesOfAnySize) {
  std::vector<RenderedImage> images;
  for (const float scale : {1.0F, 1e-30F, 1e30F}) {
    const Volume ball = ballField({41, 41, 41}, 14.0);
    const Volume volume = makeField({41, 41, 41}, [&, field = reference::denseField(ball)](int i, int j, int k) {
      return scale * field.at(i, j, k);
    });
    images.push_back(drawFrom(volume, cameraAt(middleOf(volume) + Vec3(0.05, -0.09, 0.04), middleOf(volume)), 0));
  }
  for (const RenderedImage& image : images) {
    int differing = 0;
    for (std::size_t n = 0; n < image.rgba.size(); ++n) differing += std::abs(image.rgba[n] - images[0].rgba[n]) > 1;
    EXPECT_EQ(differing, 0);
  }
}

// The field is linear in the distance from the middle [voxel], so along i the surface is 14 voxels out; trilinear
// interpolation of a distance sags by at most h^2/(8R) a dimension: 3/(8*14) = 0.027 voxel.
TEST(Drawing, MeetsASphereWhereItIs) {
  const Volume volume = ballField({53, 41, 37}, 14.0);
  const Vec3 eye = middleOf(volume) + Vec3(0.08, 0, 0);
  Camera camera = cameraAt(eye, middleOf(volume));
  const RenderedImage image = drawFrom(volume, camera, 0.0);
  const double h = volume.lattice().spacing_m.x();
  EXPECT_NEAR(image.distance_m[static_cast<std::size_t>(23) * 61 + 30], 0.08 - 14 * h, (0.027 + 2e-3) * h);
}

// An object that fills the volume is seen as its cut faces, with the face's depth.
TEST(Drawing, ShowsTheCutFaceOfAnObjectThatFillsTheVolume) {
  const Volume volume =
      makeField({20, 20, 20}, [](int i, int j, int k) { return static_cast<float>(10 + (i + j + k) % 3); });
  const Vec3 eye = middleOf(volume) + Vec3(0.08, 0, 0);
  const RenderedImage image = drawFrom(volume, cameraAt(eye, middleOf(volume)), 0.0);
  const double half_m = 9.5 * volume.lattice().spacing_m.x();
  EXPECT_NEAR(image.distance_m[static_cast<std::size_t>(23) * 61 + 30], 0.08 - half_m, 1e-6);
}

TEST(Drawing, SeesNothingWhereThereIsNothing) {
  const Volume volume = ballField({24, 24, 24}, 6.0);
  const RenderedImage image = drawFrom(volume, cameraAt(middleOf(volume) + Vec3(0.08, 0, 0), middleOf(volume)), 100.0);
  for (const float depth : image.distance_m) EXPECT_TRUE(std::isinf(depth));
}

}  // namespace drawing_test
}  // namespace palpate
