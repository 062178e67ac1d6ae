// SPDX-License-Identifier: Apache-2.0
// Cameras against the projection of every point that must be seen.
#include "apps/render/fit_camera.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "apps/render/view_words.hpp"

namespace palpate {
namespace fit_camera_test {

// Turned around an axis that is none of the world's; `sign` -1: left-handed.
Lattice turnedLattice(double sign) {
  Lattice lattice;
  lattice.origin_W = {0.1, -0.2, 0.05};
  lattice.R_WL = Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  lattice.R_WL.col(1) *= sign;
  lattice.spacing_m = {0.7e-3, 0.9e-3, 1.3e-3};
  return lattice;
}

// How far a point is from the middle of the picture: 1 at an edge.
double shareOf(const Camera& camera, const Vec3& p_W) {
  const auto seen = camera.project(p_W);
  if (!seen) return 1e9;
  return std::max(std::abs(2 * seen->x / camera.width - 1), std::abs(2 * seen->y / camera.height - 1));
}

// How far the points reach along a direction [voxel].
double reachOf(const SeenExtent& extent, const Lattice& lattice, const Vec3& direction) {
  double reach = -1e9;
  for (const Vec3& p_W : extent.points_W) reach = std::max(reach, direction.dot(lattice.toIndex(p_W)));
  return reach;
}

// Of all frames.
double largestShare(const RenderRequest& request, const SeenExtent& extent) {
  const double distance_m = fittingDistance(request, extent);
  double largest = 0;
  for (int frame = 0; frame < request.frames; ++frame) {
    const Camera camera = frameCamera(request, targetOf(request, extent), distance_m, frame);
    for (const Vec3& p_W : extent.points_W) largest = std::max(largest, shareOf(camera, p_W));
  }
  return largest;
}

// Some point is exactly on the margin, and none beyond it, from every side, in wide, high and turning pictures. 1e-9:
// rounding of a few operations on numbers up to 1e3.
TEST(FitCamera, EverythingIsInThePictureAndFillsIt) {
  for (const double sign : {1.0, -1.0}) {
    const SeenExtent extent = wholeExtent({Vec3i(40, 60, 21), Vec3::Ones()}, turnedLattice(sign));
    ASSERT_EQ(extent.points_W.size(), 8U);
    for (const std::string& name : viewNames()) {
      for (const auto& [width, height] : {std::pair(64, 48), std::pair(30, 90)}) {
        for (const int frames : {1, 7}) {
          RenderRequest request;
          request.width = width;
          request.height = height;
          request.frames = frames;
          request.view = *viewNamed(name);
          request.fov_rad = 0.9;
          EXPECT_NEAR(largestShare(request, extent), kFilledShare, 1e-9) << name << ' ' << width << ' ' << frames;
          request.target_W = extent.middle_W + Vec3(0.01, -0.02, 0.005);
          EXPECT_NEAR(largestShare(request, extent), kFilledShare, 1e-9) << name << ", another target";
        }
      }
    }
  }
}

TEST(FitCamera, StandsWhereItIsTold) {
  RenderRequest request;
  request.view = *viewNamed("left");
  const Camera camera = frameCamera(request, Vec3(1, 2, 3), 0.5, 0);
  EXPECT_TRUE(camera.position_W.isApprox(Vec3(1.5, 2, 3), 1e-15));
  EXPECT_TRUE(camera.forward_W.isApprox(-Vec3::UnitX(), 1e-15));
  EXPECT_TRUE(camera.right_W.isApprox(Vec3::UnitY(), 1e-15));  // the back of a patient seen from the left
  EXPECT_TRUE(camera.up_W.isApprox(Vec3::UnitZ(), 1e-15));
  EXPECT_NEAR(camera.vertical_fov_rad, request.fov_rad, 1e-15);
}

// A point 1 cm up and 2 cm to the right appears three times as far from the middle.
TEST(FitCamera, ZoomsAroundTheMiddle) {
  RenderRequest request;
  const Vec3 p_W(0.02, 0, 0.01);
  const auto plain = frameCamera(request, Vec3::Zero(), 0.5, 0).project(p_W);
  request.zoom = 3;
  const Camera camera = frameCamera(request, Vec3::Zero(), 0.5, 0);
  const auto zoomed = camera.project(p_W);
  ASSERT_TRUE(plain && zoomed);
  EXPECT_NEAR(zoomed->x - 640, 3 * (plain->x - 640), 1e-9);
  EXPECT_NEAR(zoomed->y - 360, 3 * (plain->y - 360), 1e-9);
  EXPECT_GT(zoomed->x, 640);
  EXPECT_LT(zoomed->y, 360);
  EXPECT_EQ(camera.position_W, frameCamera({}, Vec3::Zero(), 0.5, 0).position_W);
}

// A quarter of a turn from the front is the patient's left; the height stays.
TEST(FitCamera, ATurnGoesToThePatientsLeft) {
  RenderRequest request;
  request.frames = 4;
  request.view = *viewAnglesOf("0,30");
  const Vec3 first = frameCamera(request, Vec3::Zero(), 1, 0).position_W;
  const Vec3 second = frameCamera(request, Vec3::Zero(), 1, 1).position_W;
  EXPECT_TRUE(first.isApprox(Vec3(0, -std::sqrt(0.75), 0.5), 1e-15)) << first.transpose();
  EXPECT_TRUE(second.isApprox(Vec3(std::sqrt(0.75), 0, 0.5), 1e-15)) << second.transpose();
}

// Voxel (8, 3, 17) alone is object. It is a corner of cells of the bricks (0, 0, 2), whose cells end at voxel 8, and
// (1, 0, 2). Their cells reach from voxel (0, 0, 16) to (16, 8, 23), where the domain ends.
TEST(FitCamera, TheObjectIsInTheRowsOfBricksThatHoldIt) {
  const BrickGrid grid{Vec3i(40, 16, 24), Vec3::Ones()};
  std::vector<layout::BrickBounds> bounds(grid.brickCount(), {-1, 0});
  bounds[grid.index({0, 0, 2})] = bounds[grid.index({1, 0, 2})] = {-1, 10};
  const Lattice lattice = turnedLattice(-1);
  const SeenExtent extent = objectExtent(bounds, grid, lattice, 0);
  ASSERT_EQ(extent.points_W.size(), 8U);
  EXPECT_NEAR(reachOf(extent, lattice, {-1, -2, -3}), -3 * 16, 1e-12);  // its first corner
  EXPECT_NEAR(reachOf(extent, lattice, {1, 2, 3}), 16 + 2 * 8 + 3 * 23, 1e-12);
  EXPECT_TRUE(lattice.toIndex(extent.middle_W).isApprox(Vec3(8, 4, 19.5), 1e-12));
  // Another row, to the domain's last voxel along i.
  bounds[grid.index({4, 1, 0})] = {0, 10};
  const SeenExtent two = objectExtent(bounds, grid, lattice, 0);
  ASSERT_EQ(two.points_W.size(), 16U);
  EXPECT_NEAR(reachOf(two, lattice, {1, 2, -3}), 39 + 2 * 15, 1e-12);
  EXPECT_TRUE(lattice.toIndex(two.middle_W).isApprox(Vec3(19.5, 7.5, 11.5), 1e-12));
}

// The same from every voxel of every brick that is object and not behind one of the planes, one by one. A reach of up
// to 100 voxels along a direction of length 1: 1e-10 is rounding.
TEST(FitCamera, TheHullHoldsWhatClipsLeaveOfTheObject) {
  const BrickGrid grid{Vec3i(75, 60, 52), Vec3::Ones()};
  const Lattice lattice = turnedLattice(-1);
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const auto direction = [&] { return Vec3(normal(random), normal(random), normal(random)).normalized(); };
  for (std::size_t count = 0; count <= 3; ++count) {
    std::vector<layout::BrickBounds> bounds(grid.brickCount());
    for (auto& brick : bounds) brick = {-1, random() % 6 == 0 ? 1.0F : -0.5F};
    std::vector<ViewPlane> clips(count);
    for (ViewPlane& clip : clips) {
      clip.normal_W = direction();
      clip.offset_m = clip.normal_W.dot(lattice.toWorld(grid.size.cast<double>() / 2)) - 0.005;
    }
    SeenExtent expected;
    grid.forEach([&](const Vec3i& at) {
      const std::uint32_t brick = grid.index(at);
      if (bounds[brick].highest <= 0) return;
      std::vector<Vec3> corners_W;
      for (int corner = 0; corner < 8; ++corner) {
        const Vec3i voxel = kBrickSize * (at + Vec3i(corner & 1, corner >> 1 & 1, corner >> 2));
        corners_W.push_back(lattice.toWorld(voxel.cwiseMin(grid.size - Vec3i::Ones()).cast<double>()));
      }
      const bool is_left = std::all_of(clips.begin(), clips.end(), [&](const ViewPlane& clip) {
        return std::any_of(corners_W.begin(), corners_W.end(),
                           [&](const Vec3& p_W) { return clip.normal_W.dot(p_W) >= clip.offset_m; });
      });
      if (is_left) expected.points_W.insert(expected.points_W.end(), corners_W.begin(), corners_W.end());
    });
    ASSERT_FALSE(expected.points_W.empty());
    const SeenExtent extent = objectExtent(bounds, grid, lattice, 0, clips);
    if (count == 0) {
      EXPECT_LT(extent.points_W.size(), expected.points_W.size() / 2);
    }
    for (int n = 0; n < 200; ++n) {
      const Vec3 along = direction();
      EXPECT_NEAR(reachOf(extent, lattice, along), reachOf(expected, lattice, along), 1e-10) << count;
    }
  }
}

// A few voxels that are object, anywhere: the box around them and their cells, voxel by voxel. The bounds are those of
// the cells that begin in each brick.
TEST(FitCamera, TheBoxOfTheObjectIsExactToAVoxel) {
  std::mt19937 random(8);
  for (int trial = 0; trial < 200; ++trial) {
    Vec3i size;
    for (int axis = 0; axis < 3; ++axis) size[axis] = 2 + static_cast<int>(random() % 39);
    const Lattice lattice = turnedLattice(trial % 2 == 0 ? 1 : -1);
    std::vector<float> densities(static_cast<std::size_t>(size.prod()), -1);
    Vec3i first = size, last = Vec3i::Zero();
    for (unsigned n = 0; n < 1 + random() % 3; ++n) {
      Vec3i voxel;
      for (int axis = 0; axis < 3; ++axis) voxel[axis] = static_cast<int>(random() % static_cast<unsigned>(size[axis]));
      densities[static_cast<std::size_t>(voxel.x() + size.x() * (voxel.y() + size.y() * voxel.z()))] = 1;
      first = first.cwiseMin((voxel - Vec3i::Ones()).cwiseMax(Vec3i::Zero()));
      last = last.cwiseMax((voxel + Vec3i::Ones()).cwiseMin(size - Vec3i::Ones()));
    }
    const Volume volume = Volume::fromDense(size, lattice, densities, {});
    const BrickGrid grid{size, lattice.spacing_m};
    std::vector<layout::BrickBounds> bounds(grid.brickCount(), {-1, -1});
    for (int k = 0; k < size.z(); ++k) {
      for (int j = 0; j < size.y(); ++j) {
        for (int i = 0; i < size.x(); ++i) {
          if (densities[static_cast<std::size_t>(i + size.x() * (j + size.y() * k))] < 0) continue;
          // A voxel is a corner of the cells that begin at it and one before it.
          for (int before = 0; before < 8; ++before) {
            const Vec3i cell = Vec3i(i, j, k) - Vec3i(before & 1, before >> 1 & 1, before >> 2);
            if ((cell.array() >= 0).all()) bounds[grid.index(cell / kBrickSize)].highest = 1;
          }
        }
      }
    }
    const SeenExtent extent = objectExtent(bounds, grid, lattice, 0, {}, &volume);
    const Vec3 middle = (first + last).cast<double>() / 2;
    EXPECT_TRUE(lattice.toIndex(extent.middle_W).isApprox(middle, 1e-9)) << trial;
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(reachOf(extent, lattice, Vec3::Unit(axis)), last[axis], 1e-9) << trial;
      EXPECT_NEAR(reachOf(extent, lattice, -Vec3::Unit(axis)), -first[axis], 1e-9) << trial;
    }
  }
}

// Half the volume is twice as large in the picture, from half as far.
TEST(FitCamera, AClippedVolumeFillsThePicture) {
  const BrickGrid grid{Vec3i(41, 2, 21), Vec3::Ones()};
  const ViewPlane clips[] = {{Vec3::UnitX(), 0.02}, {Vec3::UnitZ(), 0.01}};
  const SeenExtent extent = wholeExtent(grid, {}, clips);
  EXPECT_TRUE(extent.middle_W.isApprox(Vec3(0.03, 0.0005, 0.015), 1e-12));
  RenderRequest request;
  EXPECT_NEAR(largestShare(request, extent), kFilledShare, 1e-9);
  const double whole_m = fittingDistance(request, wholeExtent(grid, {}));
  EXPECT_NEAR(fittingDistance(request, extent) - 0.0005, (whole_m - 0.0005) / 2, 1e-12);  // to the face in front
}

TEST(FitCamera, CanBeStoppedBetweenFrames) {
  const SeenExtent extent = wholeExtent({Vec3i::Constant(9), Vec3::Ones()}, {});
  RenderRequest request;
  request.frames = 7;
  int frames = 0;
  (void)fittingDistance(request, extent, [&] { ++frames; });
  EXPECT_EQ(frames, 7);
  EXPECT_THROW((void)fittingDistance(request, extent, [] { throw std::runtime_error("stop"); }), std::runtime_error);
}

TEST(FitCamera, WithoutAnObjectTheWholeVolumeIsSeen) {
  const BrickGrid grid{Vec3i(40, 16, 24), Vec3::Ones()};
  const std::vector<layout::BrickBounds> bounds(grid.brickCount(), {-1, 0});
  const Lattice lattice = turnedLattice(1);
  const SeenExtent extent = objectExtent(bounds, grid, lattice, 0);  // at the isovalue is no object
  ASSERT_EQ(extent.points_W.size(), 8U);
  EXPECT_TRUE(lattice.toIndex(extent.middle_W).isApprox(Vec3(19.5, 7.5, 11.5), 1e-12));
  // And what the planes leave of it.
  const ViewPlane clip{-lattice.R_WL.col(0), -lattice.R_WL.col(0).dot(lattice.toWorld({10, 0, 0}))};
  const SeenExtent clipped = objectExtent(bounds, grid, lattice, 0, std::span(&clip, 1));
  EXPECT_TRUE(lattice.toIndex(clipped.middle_W).isApprox(Vec3(5, 7.5, 11.5), 1e-12));
}

}  // namespace fit_camera_test
}  // namespace palpate
