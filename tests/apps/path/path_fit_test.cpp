// SPDX-License-Identifier: Apache-2.0
// A path for which nothing was asked, on bodies of every size and shape: it must begin and end free and keep to the
// object while it slides. Truth: the field itself, sampled along the path.
#include "apps/path/path_fit.hpp"

#include <numbers>
#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/path/touch_path.hpp"
#include "grid_field.hpp"

namespace palpate {
namespace path_fit_test {

using Formula = std::function<double(const Vec3&)>;

const PathPhase& phase(const TouchPath& path, const std::string& name) {
  return *std::find_if(path.phases.begin(), path.phases.end(), [&](const PathPhase& p) { return p.name == name; });
}

// The fields have a slope of one or more a voxel; a surface point is found to 1e-4 voxel.
constexpr double kOnSurface = 1e-3;

// Of the points of a phase: how many are in the object.
double shareInside(const SurfaceField& field, const TouchPath& path, const std::string& name) {
  const PathPhase& its = phase(path, name);
  int inside = 0, all = 0;
  for (const TimedPoint& point : path.points) {
    if (point.time_s < its.begin_s || point.time_s >= its.end_s) continue;
    ++all;
    inside += heightAt(field, point.p_W).value_or(-1) > kOnSurface ? 1 : 0;
  }
  return static_cast<double>(inside) / all;
}

// Whether the tool, once out of the object in the retreat, stays out.
bool retreatIsFree(const SurfaceField& field, const TouchPath& path) {
  bool out = false;
  for (const TimedPoint& point : path.points) {
    if (point.time_s < phase(path, "retreat").begin_s) continue;
    const bool inside = heightAt(field, point.p_W).value_or(-1) > 0;
    if (inside && out) return false;
    out = out || !inside;
  }
  return out;
}

void expectGood(const SurfaceField& field, const TouchPath& path) {
  EXPECT_EQ(shareInside(field, path, "approach"), 0);
  EXPECT_EQ(shareInside(field, path, "slide"), 1);
  EXPECT_TRUE(retreatIsFree(field, path));
  EXPECT_THAT(path.notes, testing::IsEmpty());
}

TEST(PathFit, IsAFingersOnWhatAFingerFeels) {
  for (const double size_m : {0.03, 0.1, 0.25, 0.4}) {
    const PathFit fit = fitTo(size_m, 1e-3);
    EXPECT_DOUBLE_EQ(fit.approach_m, 10e-3) << size_m;
    EXPECT_DOUBLE_EQ(fit.slide_m, 20e-3) << size_m;
    EXPECT_DOUBLE_EQ(fit.most_depth_m, 1e-3) << size_m;
  }
}

// Below 3 cm half, 0.7 and a sixteenth of the object; above 40 cm a 40th, a 20th and a 400th of it; two voxels and a
// twentieth of a voxel where that is more; and no depth above 4 mm.
TEST(PathFit, IsASetShareOfWhatIsSmallOrLarge) {
  const auto expectFit = [](const PathFit& fit, double approach_m, double slide_m, double most_depth_m) {
    EXPECT_DOUBLE_EQ(fit.approach_m, approach_m);
    EXPECT_DOUBLE_EQ(fit.slide_m, slide_m);
    EXPECT_DOUBLE_EQ(fit.most_depth_m, most_depth_m);
  };
  expectFit(fitTo(0.01, 1e-4), 5e-3, 7e-3, 0.625e-3);
  expectFit(fitTo(0.01, 20e-3), 40e-3, 7e-3, 1e-3);
  expectFit(fitTo(1, 1e-3), 25e-3, 50e-3, 2.5e-3);
  expectFit(fitTo(2, 1e-3), 50e-3, 100e-3, 4e-3);
}

TEST(PathFit, SizeIsTheLongestEdgeOfTheBox) {
  Lattice lattice;
  lattice.spacing_m = Vec3(1e-3, 3e-3, 5e-3);
  EXPECT_DOUBLE_EQ(sizeOf({9, Vec3i(1, 2, 3), Vec3i(4, 3, 3)}, lattice), 6e-3);  // 4, 6 and 5 mm
  EXPECT_DOUBLE_EQ(sizeOf({9, Vec3i(1, 2, 3), Vec3i(7, 3, 3)}, lattice), 7e-3);
}

// From a grain of a micrometre to a mountain: never larger than the object, never less than its samples can show.
TEST(PathFit, GrowsAndShrinksWithTheObject) {
  PathFit last;
  for (double size_m = 1e-7; size_m < 1e4; size_m *= 1.3) {
    const double voxel_m = size_m / 100;
    const PathFit fit = fitTo(size_m, voxel_m);
    EXPECT_LE(fit.slide_m, 0.7 * size_m * (1 + 1e-12));
    EXPECT_LE(fit.approach_m, 0.5 * size_m * (1 + 1e-12));
    EXPECT_LE(fit.most_depth_m, size_m / 16 * (1 + 1e-12));
    EXPECT_GE(fit.slide_m, size_m / 20 * (1 - 1e-12));
    EXPECT_GE(fit.approach_m, 2 * voxel_m * (1 - 1e-12));
    EXPECT_GE(fit.most_depth_m, std::min(0.05 * voxel_m, 4e-3) * (1 - 1e-12));
    EXPECT_LE(fit.most_depth_m, 4e-3);  // 2 N
    EXPECT_GE(fit.slide_m, last.slide_m);
    EXPECT_GE(fit.approach_m, last.approach_m);
    EXPECT_GE(fit.most_depth_m, last.most_depth_m);
    last = fit;
  }
}

// A slab of 3 mm, felt from above: steps are an eighth of a voxel.
TEST(PathFit, ThicknessIsThatOfASlab) {
  const AnalyticField slab([](const Vec3& p) { return 1.5e-3 - std::abs(p.z()); }, 20e-3, 0.5e-3);
  const SurfaceHit top{Vec3(1e-3, 2e-3, 1.5e-3), Vec3::UnitZ()};
  EXPECT_NEAR(thicknessAt(slab, top, 10e-3), 3e-3, 0.5e-3 / 8);
  EXPECT_EQ(thicknessAt(slab, top, 2e-3), 2e-3);
}

// A mask of zeros and ones is 2.97 mm thick, and what is at the isovalue is outside. The thickness is that of the last
// step in it: of an eighth of a voxel, of a sixteenth of the reach, or of a 4096th of a reach of a metre.
TEST(PathFit, ThicknessIsThatOfTheLastStepInside) {
  const AnalyticField mask([](const Vec3& p) { return p.z() > -2.97e-3 ? 1.0 : 0.0; }, 20e-3, 0.5e-3);
  const SurfaceHit top{Vec3(1e-3, 2e-3, 0), Vec3::UnitZ()};
  EXPECT_NEAR(thicknessAt(mask, top, 10e-3), 2.9375e-3, 1e-12);
  EXPECT_NEAR(thicknessAt(mask, {Vec3(0, 0, -2.55e-3), Vec3::UnitZ()}, 0.8e-3), 0.4e-3, 1e-12);
  EXPECT_NEAR(thicknessAt(mask, top, 1.024), 2.75e-3, 1e-12);
}

// A straight curve of 20 points a millimetre apart on an object whose thickness [mm] differs from point to point.
SurfaceCurve onTop() {
  SurfaceCurve curve;
  curve.step_m = 1e-3;
  for (int i = 0; i < 20; ++i) curve.points.push_back({Vec3(i * 1e-3, 0, 0), Vec3::UnitZ()});
  return curve;
}
double depthOn(const std::vector<double>& thick_mm, double most_depth_m) {
  const AnalyticField field(
      [&](const Vec3& p) {
        const auto i = static_cast<std::size_t>(std::clamp(std::lround(p.x() * 1e3), 0L, 19L));
        return std::min(-p.z(), p.z() + 1e-3 * thick_mm[i]);
      },
      30e-3, 1e-3);
  PathFit fit;
  fit.most_depth_m = most_depth_m;
  return depthFor(field, onTop(), fit);
}

// From 1.06 mm upwards by 0.25 mm, the thinnest last: two of 20 may be thinner than the tenth percentile, 1.56 mm.
// Steps are an eighth of a millimetre, so that is felt as 1.5 mm.
TEST(PathFit, DepthIsAQuarterOfWhatNineTenthsAreThickerThan) {
  std::vector<double> thick_mm(20);
  for (std::size_t i = 0; i < 20; ++i) thick_mm[i] = 1.06 + 0.25 * static_cast<double>(19 - i);
  EXPECT_NEAR(depthOn(thick_mm, 0.5e-3), 0.375e-3, 1e-12);
  thick_mm[19] = 0.2;  // there the tool would come out below; at half of the depth it does not
  EXPECT_NEAR(depthOn(thick_mm, 0.5e-3), 0.1875e-3, 1e-12);
}

TEST(PathFit, DepthIsAtLeastATwentiethOfAVoxelUnlessThatIsTooDeep) {
  const std::vector<double> paper(20, 0.01);
  EXPECT_DOUBLE_EQ(depthOn(paper, 0.5e-3), 0.05e-3);
  EXPECT_DOUBLE_EQ(depthOn(paper, 0.03e-3), 0.03e-3);
}

// Balls from 3 samples across, at every spacing from a micrometre on, also where it differs by axis.
TEST(PathFit, HoldsOnBallsOfEverySize) {
  for (const double voxel_m : {1e-6, 1e-4, 1e-3, 0.05}) {
    for (const double radius : {1.5, 2.3, 5.0, 12.0}) {
      for (const Vec3& shape : {Vec3(1, 1, 1), Vec3(1, 1, 2.5), Vec3(1.7, 0.6, 1)}) {
        SCOPED_TRACE(fmt::format("voxel {} m, radius {} voxels, shape {} {} {}", voxel_m, radius, shape.x(), shape.y(),
                                 shape.z()));
        const Vec3 spacing_m = voxel_m * shape;
        const double radius_m = radius * spacing_m.maxCoeff();
        const Vec3i size = (2 * (radius_m / spacing_m.array()).ceil() + 14).cast<int>();
        const GridField field(size, spacing_m, [&](const Vec3& p) { return (radius_m - p.norm()) / voxel_m; });
        const TouchPath path = buildTouchPath(field, {});
        expectGood(field, path);
        EXPECT_LT(path.slid_m, 2 * radius_m);
        EXPECT_LT(path.depth_m, 0.2 * radius_m);
      }
    }
  }
}

// A plate, however thin, is pressed by no more than a quarter of its thickness, and stays touched.
TEST(PathFit, PressesAThinPlateLess) {
  for (const double thick_voxels : {1.2, 2.0, 3.0, 6.0}) {
    for (const double tilt : {0.0, 0.2, 0.5}) {
      SCOPED_TRACE(fmt::format("{} voxels thick, tilted by {}", thick_voxels, tilt));
      const Vec3 up = Vec3(std::sin(tilt), 0, std::cos(tilt));
      const double half_m = 0.5e-3 * thick_voxels;
      const GridField field(Vec3i(60, 60, 50), Vec3::Constant(1e-3), [&](const Vec3& p) {
        const double across = std::abs(p.dot(up)) - half_m;
        return -1e3 * std::max({across, std::abs(p.y()) - 25e-3, std::abs(p.x()) - 25e-3});
      });
      const TouchPath path = buildTouchPath(field, {});
      expectGood(field, path);
      EXPECT_LE(path.depth_m, 0.5 * half_m * 1.1 + 0.125e-3);  // the tenth that may be thinner, and the step
      EXPECT_GE(path.slid_m, 15e-3);
    }
  }
}

// A rod is slid along, not around.
TEST(PathFit, SlidesAlongARod) {
  const Vec3 along = Vec3(1, 0.3, 0.2).normalized();
  const GridField field(Vec3i(90, 50, 50), Vec3::Constant(1e-3), [&](const Vec3& p) {
    const double s = std::clamp(p.dot(along), -35e-3, 35e-3);
    return 1e3 * (2.5e-3 - (p - s * along).norm());
  });
  const TouchPath path = buildTouchPath(field, {});
  expectGood(field, path);
  EXPECT_NEAR(path.slid_m, 20e-3, 1e-12);
  Vec3 first = Vec3::Zero(), last = Vec3::Zero();
  for (const TimedPoint& point : path.points) {
    if (point.time_s <= phase(path, "slide").begin_s) first = point.p_W;
    if (point.time_s < phase(path, "slide").end_s) last = point.p_W;
  }
  EXPECT_GT(std::abs((last - first).dot(along)), 17e-3);
}

// A head and, behind and above it, a headrest that every ray from above meets first.
TEST(PathFit, BeginsOnTheLargestPiece) {
  const GridField field(Vec3i(70, 70, 70), Vec3::Constant(1e-3), [](const Vec3& p) {
    const double head = 20e-3 - p.norm();
    const double rest = 1.5e-3 - std::abs((p - Vec3(0, 0, -5e-3)).norm() - 32e-3);  // a shell, cut in half
    return 1e3 * std::max(head, p.z() > 5e-3 ? std::min(rest, p.z() - 5e-3) : -1e-3);
  });
  for (const auto& toward_W : {std::optional<Vec3>(), std::optional<Vec3>(-Vec3::UnitZ())}) {
    PathRequest request;
    request.toward_W = toward_W;
    const TouchPath path = buildTouchPath(field, request);
    EXPECT_NEAR(path.start.p_W.norm(), 20e-3, 0.1e-3);
    EXPECT_EQ(shareInside(field, path, "slide"), 1);
    EXPECT_TRUE(retreatIsFree(field, path));
  }
}

// Far from the middle of the volume, where no ray through the middle comes.
TEST(PathFit, FindsASmallBodyInACorner) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 20; ++trial) {
    const auto place = [&] { return std::uniform_real_distribution<double>(-25e-3, 25e-3)(random); };
    const Vec3 centre(place(), place(), place());
    const double radius_m = std::uniform_real_distribution<double>(1.5e-3, 3.5e-3)(random);
    const GridField field(Vec3i::Constant(60), Vec3::Constant(1e-3),
                          [&](const Vec3& p) { return 1e3 * (radius_m - (p - centre).norm()); });
    SCOPED_TRACE(trial);
    expectGood(field, buildTouchPath(field, {}));
  }
}

// A helix of wire: the grid of rays may pass between its turns.
TEST(PathFit, FindsACurledWire) {
  const GridField field(Vec3i::Constant(64), Vec3::Constant(1e-3), [&](const Vec3& p) {
    double nearest = 1;
    for (double t = std::atan2(p.y(), p.x()); t < 12.6; t += 2 * std::numbers::pi) {
      const double near = std::max(t, 0.0);
      nearest = std::min(nearest, (p - 1e-3 * Vec3(22 * std::cos(near), 22 * std::sin(near), 4 * near - 25)).norm());
    }
    return 1e3 * (1.6e-3 - nearest);
  });
  expectGood(field, buildTouchPath(field, {}));
}

// A slit of 3 mm: the normal's way out of it is short, that along it is not.
TEST(PathFit, LeavesASlitWhereItIsOpen) {
  const GridField field(Vec3i(60, 60, 60), Vec3::Constant(1e-3), [](const Vec3& p) {
    const double block = 22e-3 - p.cwiseAbs().maxCoeff();
    const double slit = std::min(1.5e-3 - std::abs(p.x()), p.z() + 5e-3);
    return 1e3 * std::min(block, -slit);
  });
  PathRequest request;
  request.start_W = Vec3(1.5e-3, 0, 14e-3);
  request.slide_W = Vec3::UnitY();
  request.slide_length_m = 5e-3;
  request.press_depth_m = 0.5e-3;
  const TouchPath path = buildTouchPath(field, request);
  EXPECT_EQ(shareInside(field, path, "approach"), 0);
  EXPECT_EQ(shareInside(field, path, "slide"), 1);
  EXPECT_TRUE(retreatIsFree(field, path));
  EXPECT_GT((path.points.back().p_W - path.start.p_W).norm(), 6e-3);
  EXPECT_GT((path.points.front().p_W - path.start.p_W).norm(), 6e-3);
}

// What is asked for is done and, where it cannot be, told.
TEST(PathFit, TellsThatAPressComesOutOnTheOtherSide) {
  const GridField field(Vec3i(60, 60, 30), Vec3::Constant(1e-3), [](const Vec3& p) {
    return 1e3 * std::min(0.8e-3 - std::abs(p.z()), 25e-3 - p.cwiseAbs().maxCoeff());
  });
  PathRequest request;
  request.press_depth_m = 2e-3;
  request.slide_length_m = 10e-3;
  const TouchPath path = buildTouchPath(field, request);
  EXPECT_EQ(path.depth_m, 2e-3);
  ASSERT_FALSE(path.notes.empty());
  EXPECT_THAT(path.notes[0], testing::HasSubstr("over 10 mm of the slide the path is not in the object: "
                                                "at a depth of 2 mm it comes out on another side; press less deep"));
}

}  // namespace path_fit_test
}  // namespace palpate
