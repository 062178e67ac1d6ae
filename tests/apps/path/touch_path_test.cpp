// SPDX-License-Identifier: Apache-2.0
#include "apps/path/touch_path.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "analytic_field.hpp"
#include "base/error.hpp"

namespace palpate {
namespace touch_path_test {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kVoxel_m = 0.5e-3;
constexpr double kRadius_m = 15e-3;

AnalyticField sphere() {
  return {[](const Vec3& p) { return sphereDistance(p, kRadius_m); }, 30e-3, kVoxel_m};
}
AnalyticField slab() {
  return {slabWithHole, 30e-3, kVoxel_m};
}
AnalyticField plane() {
  return {[](const Vec3& p) { return -p.z(); }, 12e-3, kVoxel_m};
}

const PathPhase& phase(const TouchPath& path, const std::string& name) {
  for (const PathPhase& p : path.phases) {
    if (p.name == name) return p;
  }
  throw std::out_of_range(name);
}

Vec3 at(const TouchPath& path, double time_s) {
  const double place = time_s / path.points.back().time_s * static_cast<double>(path.points.size() - 1);
  return path.points[static_cast<std::size_t>(std::lround(place))].p_W;
}

void expectRefusal(const SurfaceField& field, const PathRequest& request, const std::string& words) {
  try {
    (void)buildTouchPath(field, request);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::Code::kBadInput);
    EXPECT_THAT(error.what(), HasSubstr(words));
  }
}

TEST(TouchPath, StartsOutsidePressesSlidesAndLeaves) {
  const TouchPath path = buildTouchPath(sphere(), {});
  EXPECT_EQ(path.points.front().time_s, 0);
  EXPECT_EQ(path.points.back().time_s, 5.0);  // exact
  EXPECT_NEAR(-sphereDistance(path.points.front().p_W, kRadius_m), 10e-3, 1e-9);
  EXPECT_NEAR(-sphereDistance(path.points.back().p_W, kRadius_m), 10e-3, 1e-8);
  EXPECT_NEAR(sphereDistance(at(path, phase(path, "press").end_s), kRadius_m), 1e-3, 1e-9);
  EXPECT_NEAR(path.slid_m, 20e-3, 1e-12);
  EXPECT_THAT(path.notes, IsEmpty());
}

// On a plane everything is known. A quarter of a phase's time is 0.25^3 (10 - 15/4 + 6/16) = 0.103515625 of its way.
TEST(TouchPath, GoesItsWayInEachPhase) {
  PathRequest request;
  request.duration_s = 4;
  request.approach_m = 5e-3;
  request.press_depth_m = 1e-3;
  request.slide_length_m = 6e-3;
  request.start_W = Vec3(1e-3, 2e-3, 0.3e-3);
  request.slide_W = Vec3(2, 0, 0);
  const TouchPath path = buildTouchPath(plane(), request);
  ASSERT_EQ(path.points.size(), 2001U);
  ASSERT_EQ(path.phases.size(), 4U);
  const std::array<double, 4> begin_s = {0, 0.6, 1.2, 3.4};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_DOUBLE_EQ(path.phases[i].begin_s, begin_s[i]);
  const double share = 0.103515625;
  const Vec3 start = path.start.p_W;
  EXPECT_LT((start - Vec3(1e-3, 2e-3, 0)).norm(), 0.01 * kVoxel_m);
  const std::array<Vec3, 4> expected = {start + Vec3(0, 0, (1 - share) * 5e-3), start + Vec3(0, 0, -share * 1e-3),
                                        start + Vec3(share * 6e-3, 0, -1e-3),
                                        start + Vec3(6e-3, 0, -1e-3 + share * 6e-3)};
  for (std::size_t i = 0; i < 4; ++i) {
    const double time_s = 0.75 * path.phases[i].begin_s + 0.25 * path.phases[i].end_s;
    EXPECT_LT((at(path, time_s) - expected[i]).norm(), 1e-8) << i;
  }
  EXPECT_LT((path.slide_W - Vec3::UnitX()).norm(), 1e-6);
  EXPECT_NEAR(path.slid_m, 6e-3, 1e-12);
  EXPECT_EQ(path.depth_m, 1e-3);
  EXPECT_EQ(path.approach_m, 5e-3);
  EXPECT_THAT(path.notes, IsEmpty());
}

TEST(TouchPath, MayTouchAPointWithoutPressing) {
  PathRequest request;
  request.duration_s = 0.01;
  request.press_depth_m = 0;
  request.slide_length_m = 0;
  const TouchPath path = buildTouchPath(sphere(), request);
  EXPECT_EQ(path.points.size(), 9U);  // the shortest has eight intervals
  EXPECT_EQ(path.depth_m, 0);
  EXPECT_EQ(path.slid_m, 0);
  EXPECT_EQ(path.slide_W, Vec3::Zero());
  EXPECT_THAT(path.notes, IsEmpty());
}

// 2000 s in intervals of 2 ms are a million; a longer path has longer ones.
TEST(TouchPath, HasAMillionIntervalsAtMost) {
  PathRequest request;
  request.start_W = Vec3(1e-3, 2e-3, 0.3e-3);
  request.slide_length_m = 0;
  request.duration_s = 4000;
  const TouchPath path = buildTouchPath(plane(), request);
  ASSERT_EQ(path.points.size(), 1'000'001U);
  EXPECT_DOUBLE_EQ(path.points[1].time_s, 4e-3);
  EXPECT_EQ(path.points.back().time_s, 4000);
}

// The depth lacks d (1 - exp(-s^2 / 2R^2)) for the smoothed normal (s = 1 mm) and gains s_c^2 / 2R for the smoothed
// curve (s_c = 0.375 mm). Both with R = 15 mm, within 5 % of themselves; the ends are exact.
TEST(TouchPath, SlidesAtThePressDepth) {
  const TouchPath path = buildTouchPath(sphere(), {});
  const double less_m = 1e-3 * (1 - std::exp(-0.5 * 1e-6 / (kRadius_m * kRadius_m)));
  const double more_m = 0.375e-3 * 0.375e-3 / (2 * kRadius_m);
  for (const TimedPoint& point : path.points) {
    if (point.time_s < phase(path, "slide").begin_s || point.time_s > phase(path, "slide").end_s) continue;
    const double depth_m = sphereDistance(point.p_W, kRadius_m);
    EXPECT_GE(depth_m, 1e-3 - 1.05 * less_m);
    EXPECT_LE(depth_m, 1e-3 + 1.05 * more_m);
  }
}

// Minimum jerk over a way L in time T has speed at most 1.875 L/T and acceleration at most 5.7735 L/T^2; turning on the
// radius R adds v^2 / R. Between points the velocity then changes by at most acceleration * interval.
TEST(TouchPath, SpeedHasNoJumps) {
  const TouchPath path = buildTouchPath(sphere(), {});
  const double interval_s = path.points[1].time_s;
  const double slide_v = 1.875 * 20e-3 / 2.75,
               most_a = 5.7735 * 11e-3 / (0.75 * 0.75) + slide_v * slide_v / (kRadius_m - 1e-3);
  for (std::size_t i = 1; i + 1 < path.points.size(); ++i) {
    const Vec3 change = (path.points[i + 1].p_W - 2 * path.points[i].p_W + path.points[i - 1].p_W) / interval_s;
    ASSERT_LE(change.norm(), 1.05 * most_a * interval_s) << "at " << path.points[i].time_s << " s";
  }
}

// Over a sharp edge the smoothed curve bends within a Gaussian of s = 0.75 voxel: curvature (pi/2) / (s sqrt(2 pi)).
TEST(TouchPath, SpeedHasNoJumpsOverSharpEdges) {
  PathRequest request;
  request.start_W = Vec3(-12e-3, 0, 10e-3);
  request.slide_W = Vec3::UnitX();
  request.slide_length_m = 36e-3;
  const TouchPath path = buildTouchPath(slab(), request);
  const double interval_s = path.points[1].time_s, most_v = 1.875 * 36e-3 / 2.75 * 1.6, sigma_m = 0.375e-3;
  const double curvature = 1.5708 / (sigma_m * 2.5066), press_a = 5.7735 * 11e-3 / (0.75 * 0.75);
  for (std::size_t i = 1; i + 1 < path.points.size(); ++i) {
    const Vec3 change = (path.points[i + 1].p_W - 2 * path.points[i].p_W + path.points[i - 1].p_W) / interval_s;
    ASSERT_LE(change.norm(), (press_a + most_v * most_v * curvature) * interval_s)
        << "at " << path.points[i].time_s << " s";
  }
}

// In the hole the tool stays inside the object (it never shows above the surface) and never deeper than the press.
TEST(TouchPath, StaysPressedThroughAHole) {
  PathRequest request;
  request.start_W = Vec3(-12e-3, 0, 10e-3);
  request.slide_W = Vec3::UnitX();
  request.slide_length_m = 36e-3;
  const TouchPath path = buildTouchPath(slab(), request);
  double lowest_m = 1;
  for (const TimedPoint& point : path.points) {
    if (point.time_s < phase(path, "slide").begin_s || point.time_s > phase(path, "slide").end_s) continue;
    const double depth_m = slabWithHole(point.p_W);
    EXPECT_GT(depth_m, 0) << "at " << point.time_s << " s";
    // At a concave corner both walls are offset: the depth below the corner point itself is at most sqrt(2) * depth.
    EXPECT_LT(depth_m, 1.4143e-3);
    lowest_m = std::min(lowest_m, point.p_W.z());
  }
  EXPECT_NEAR(lowest_m, 2e-3 - 1e-3, 0.05e-3);  // it was on the floor of the hole, a press depth below
}

// The body as a volume has it: samples, 8-corner interpolation, gradients by central differences. Linear interpolation
// of a distance on a ball of radius R is off by at most 3/8 h^2 * 2/R; the path then keeps its depth as on the
// formula's ball.
TEST(TouchPath, KeepsItsDepthOnASampledSphere) {
  const SampledField field(sphere());
  const TouchPath path = buildTouchPath(field, {});
  const double sampling_m = 0.375 * kVoxel_m * kVoxel_m * 2 / kRadius_m,
               smoothing_m = 5e-6;  // as above: 2.3 and 4.7 um
  for (const TimedPoint& point : path.points) {
    if (point.time_s < phase(path, "slide").begin_s || point.time_s > phase(path, "slide").end_s) continue;
    EXPECT_NEAR(sphereDistance(point.p_W, kRadius_m), 1e-3, sampling_m + smoothing_m + 1e-3 * 1e-3);
  }
}

// A mask of zeros and ones is all steps of a voxel: the path still keeps its depth within a voxel and its speed steady.
TEST(TouchPath, FollowsAMaskOfZerosAndOnes) {
  AnalyticField mask([](const Vec3& p) { return sphereDistance(p, kRadius_m) > 0 ? 1.0 : 0.0; }, 30e-3, kVoxel_m);
  SampledField field(mask);
  field.setIsovalue(0.5);
  const TouchPath path = buildTouchPath(field, {});
  EXPECT_NEAR(path.slid_m, 20e-3, 1e-12);
  for (std::size_t i = 1; i < path.points.size(); ++i) {
    const TimedPoint &a = path.points[i - 1], &b = path.points[i];
    if (b.time_s < phase(path, "slide").begin_s || b.time_s > phase(path, "slide").end_s) continue;
    EXPECT_LT((b.p_W - a.p_W).norm(),
              2 * 1.875 * 20e-3 / 2.75 * (b.time_s - a.time_s));  // twice the peak of minimum jerk
    EXPECT_NEAR(sphereDistance(b.p_W, kRadius_m), 1e-3, kVoxel_m);
  }
}

TEST(TouchPath, PhasesFollowEachOther) {
  const TouchPath path = buildTouchPath(sphere(), {});
  std::vector<std::string> names;
  for (const PathPhase& p : path.phases) names.push_back(p.name);
  EXPECT_THAT(names, ElementsAre("approach", "press", "slide", "retreat"));
  EXPECT_EQ(path.phases.front().begin_s, 0);
  for (std::size_t i = 1; i < path.phases.size(); ++i) EXPECT_EQ(path.phases[i].begin_s, path.phases[i - 1].end_s);
  EXPECT_EQ(path.phases.back().end_s, 5.0);
}

TEST(TouchPath, IsTheSameEveryTime) {
  const TouchPath a = buildTouchPath(slab(), {}), b = buildTouchPath(slab(), {});
  ASSERT_EQ(a.points.size(), b.points.size());
  for (std::size_t i = 0; i < a.points.size(); ++i) EXPECT_EQ(a.points[i].p_W, b.points[i].p_W);
}

TEST(TouchPath, ComesFromTheWishedDirection) {
  PathRequest request;
  request.toward_W = Vec3(-2, 0, 0);
  const TouchPath path = buildTouchPath(sphere(), request);
  const Vec3 way = (path.start.p_W - path.points.front().p_W).normalized();
  EXPECT_LT((way - Vec3(-1, 0, 0)).norm(), 1e-9);
  EXPECT_GT(path.start.p_W.x(), 0);
}

TEST(TouchPath, SlidesInTheWishedDirection) {
  PathRequest request;
  request.start_W = Vec3(0, 0, 16e-3);
  request.slide_W = Vec3(0, 1, 0);
  const TouchPath path = buildTouchPath(sphere(), request);
  EXPECT_LT((path.start.p_W - Vec3(0, 0, kRadius_m)).norm(), 0.01 * kVoxel_m);
  EXPECT_GT(path.slide_W.y(), 0.99);
}

// In the corner of the volume only the direction away from it is as long as was asked for.
TEST(TouchPath, SlidesWhereThereIsMostRoom) {
  PathRequest request;
  request.start_W = Vec3(-10e-3, -10e-3, 1e-3);
  request.slide_length_m = 26e-3;  // along an edge there are 22 mm
  const TouchPath path = buildTouchPath(plane(), request);
  EXPECT_NEAR(path.slid_m, 26e-3, 1e-12);
  EXPECT_GT(path.slide_W.dot(Vec3(1, 1, 0).normalized()), 0.99);
  EXPECT_TRUE(path.notes.empty());
}

// On a cylinder every direction is as long as any other, and that along the axis does not bend.
TEST(TouchPath, SlidesWhereTheSurfaceBendsLeast) {
  for (const int axis : {0, 1}) {
    const AnalyticField cylinder([&](const Vec3& p) { return 8e-3 - std::hypot(p[1 - axis], p.z()); }, 25e-3, kVoxel_m);
    PathRequest request;
    request.start_W = Vec3(0, 0, 8e-3);
    request.slide_length_m = 20e-3;
    EXPECT_GT(std::abs(buildTouchPath(cylinder, request).slide_W[axis]), 0.99);
  }
}

// The start is on the crest of a wave near the border. Across the waves there is room for 22 mm: enough for a slide of
// 20 mm, which bends in each of them. Along the crest it would not bend at all, but there are only 12 mm, and slantwise
// 17 mm, 18 mm up and down the waves. A slide that bends less is not taken for one that goes farther.
TEST(TouchPath, SlidesFarRatherThanStraight) {
  for (const int axis : {0, 1}) {
    const AnalyticField waves(
        [&](const Vec3& p) { return 0.5e-3 * std::cos(2 * std::numbers::pi / 6e-3 * (p[axis] + 10e-3)) - p.z(); },
        12e-3, kVoxel_m);
    PathRequest request;
    request.start_W = -10e-3 * Vec3::Unit(axis) + 1e-3 * Vec3::UnitZ();
    request.slide_length_m = 20e-3;
    const TouchPath path = buildTouchPath(waves, request);
    EXPECT_NEAR(path.slid_m, 20e-3, 1e-12);
    EXPECT_GT(path.slide_W[axis], 0.99);
    request.slide_W = Vec3::Unit(1 - axis);  // as it might have been
    EXPECT_NEAR(buildTouchPath(waves, request).slid_m, 12e-3, kVoxel_m);
  }
}

// Over the middle of a wide plate hangs a smaller one: under it there is no room to come from, beside it there is.
TEST(TouchPath, StartsWhereThereIsRoomToComeFrom) {
  const AnalyticField field(
      [](const Vec3& p) {
        const double plate = boxDistance(p - Vec3(0, 0, -5e-3), Vec3(20e-3, 20e-3, 5e-3));
        return std::max(plate, boxDistance(p - Vec3(0, 0, 6e-3), Vec3(4e-3, 4e-3, 1e-3)));
      },
      25e-3, kVoxel_m);
  PathRequest request;
  request.toward_W = -Vec3::UnitZ();
  const TouchPath path = buildTouchPath(field, request);
  EXPECT_NEAR(path.start.p_W.z(), 0, 1e-6);
  EXPECT_GT(path.start.p_W.head<2>().cwiseAbs().maxCoeff(), 4e-3);
  EXPECT_TRUE(path.notes.empty());
}

// A roof that slopes in the middle and is level beside it, both as calm: the level place faces the tool.
TEST(TouchPath, StartsWhereTheSurfaceFacesTheTool) {
  const AnalyticField field(
      [](const Vec3& p) {
        return std::min(0.7 * std::clamp(p.x(), -4e-3, 4e-3) - p.z(), 20e-3 - p.cwiseAbs().maxCoeff());
      },
      25e-3, kVoxel_m);
  PathRequest request;
  request.toward_W = -Vec3::UnitZ();
  EXPECT_GT(buildTouchPath(field, request).start.normal_W.z(), 0.999);
}

// Of a rough place in the middle and a smooth one beside it the smooth one is chosen.
TEST(TouchPath, StartsWhereTheSurfaceIsCalm) {
  const AnalyticField field(
      [](const Vec3& p) {
        const double rough = std::max(0.0, 1 - p.head<2>().norm() / 5e-3);
        const double waves = 0.6e-3 * rough * std::sin(2500 * p.x()) * std::cos(2500 * p.y());
        return std::min(waves - p.z(), 20e-3 - p.cwiseAbs().maxCoeff());
      },
      25e-3, kVoxel_m);
  PathRequest request;
  request.toward_W = -Vec3::UnitZ();
  EXPECT_GT(buildTouchPath(field, request).start.p_W.head<2>().norm(), 4e-3);
}

TEST(TouchPath, SaysHowMuchOfTheSlideIsMissing) {
  PathRequest request;
  request.start_W = Vec3(0, 0, 1e-3);
  request.slide_W = Vec3::UnitX();
  request.approach_m = 5e-3;
  request.slide_length_m = 20e-3;
  // 12 mm and a little, which is less than a step of an eighth of a millimetre.
  const AnalyticField small([](const Vec3& p) { return -p.z(); }, 12.06e-3, kVoxel_m);
  const TouchPath path = buildTouchPath(small, request);
  EXPECT_NEAR(path.slid_m, 12e-3, 0.06e-3);
  EXPECT_THAT(path.notes,
              ElementsAre("the slide is 12 mm instead of 20 mm: the surface ends at the border of the volume"));
}

TEST(TouchPath, SaysHowMuchOfTheSlideIsOverAHole) {
  PathRequest request;
  request.start_W = Vec3(-12e-3, 0, 10e-3);
  request.slide_W = Vec3::UnitX();
  request.slide_length_m = 24e-3;
  request.over_edges = OverEdges::kStraight;
  const TouchPath path = buildTouchPath(slab(), request);
  ASSERT_EQ(path.notes.size(), 1U);
  EXPECT_NEAR(std::stod(path.notes[0]), 10, 0.5);  // the hole is 10 mm wide; a step each is lost or won at its edges
  EXPECT_THAT(path.notes[0], testing::EndsWith(" mm of the slide go straight on where the surface falls away"));
}

// In a closed hollow of radius 5.1 mm the longest way is across, 10.2 mm, of which 10 mm are whole steps of half a
// voxel, and four fifths of that are used.
TEST(TouchPath, ShortensAnApproachThatTheObjectBlocks) {
  const AnalyticField hollow([](const Vec3& p) { return p.norm() - 5.1e-3; }, 20e-3, kVoxel_m);
  PathRequest request;
  request.start_W = Vec3(5e-3, 0, 0);
  request.slide_length_m = 0;
  request.approach_m = 12e-3;
  for (const auto& toward_W : {std::optional<Vec3>(), std::optional<Vec3>(3 * Vec3::UnitX())}) {
    request.toward_W = toward_W;
    const TouchPath path = buildTouchPath(hollow, request);
    EXPECT_NEAR(path.approach_m, 8e-3, 1e-12);
    EXPECT_NEAR((path.points.front().p_W - path.start.p_W).norm(), 8e-3, 1e-9);
    EXPECT_NEAR((path.points.back().p_W - path.start.p_W).norm(), 8e-3, 1e-9);
    EXPECT_THAT(path.notes, ElementsAre("the approach is 8 mm instead of 12 mm: the object is in the way",
                                        "the retreat is 8 mm instead of 12 mm: the object is in the way"));
  }
}

TEST(TouchPath, RefusesAVolumeWithoutSurface) {
  AnalyticField field = sphere();
  field.setIsovalue(1);
  expectRefusal(field, {}, "no ray into the volume meets a surface at isovalue 1; the isovalue may be wrong");
}
TEST(TouchPath, RefusesAStartFarFromTheSurface) {
  PathRequest request;
  request.start_W = Vec3(0.5, 0, 0);
  expectRefusal(sphere(), request, "path start: no surface");
}
TEST(TouchPath, RefusesAnApproachFromInside) {
  PathRequest request;
  request.start_W = Vec3(0, 0, 15e-3);
  request.toward_W = Vec3::UnitZ();
  expectRefusal(sphere(), request, "from inside the object");
}
TEST(TouchPath, RefusesASlideAlongTheNormal) {
  PathRequest request;
  request.start_W = Vec3(0, 0, 15e-3);
  request.slide_W = Vec3::UnitZ();
  expectRefusal(plane(), request, "along the surface normal");
}
TEST(TouchPath, RefusesImpossibleNumbers) {
  const double nan = std::nan("");
  PathRequest request;
  request.duration_s = 0;
  expectRefusal(sphere(), request, "path duration: 0 s is not possible; give more than 0");
  request.duration_s = HUGE_VAL;
  expectRefusal(sphere(), request, "path duration: inf s is not possible");
  request = {};
  request.approach_m = 0;
  expectRefusal(sphere(), request, "path approach: 0 m is not possible; give more than 0");
  request = {};
  request.press_depth_m = nan;
  expectRefusal(sphere(), request, "path press depth: nan m is not possible; give 0 or more");
  request = {};
  request.slide_length_m = -1e-3;
  expectRefusal(sphere(), request, "path slide length: -0.001 m is not possible; give 0 or more");
  request = {};
  request.toward_W = Vec3::Zero();
  expectRefusal(sphere(), request, "path toward: it is not a direction; give three finite numbers");
  request = {};
  request.slide_W = Vec3(HUGE_VAL, 0, 0);
  expectRefusal(sphere(), request, "path slide: it is not a direction; give three finite numbers");
  request = {};
  request.start_W = Vec3(nan, 0, 0);
  expectRefusal(sphere(), request, "path start: it is not a point; give three finite numbers");
}

// A scan in metres that is read as millimetres: a path of 20 mm would be followed for minutes, or for days.
TEST(TouchPath, RefusesLengthsOfVeryManyVoxels) {
  for (const double voxel_m : {5e-7, 2e-7}) {
    const AnalyticField tiny = {[&](const Vec3& p) { return sphereDistance(p, 30 * voxel_m); }, 60 * voxel_m, voxel_m};
    PathRequest request;
    request.slide_length_m = 20e-3;
    expectRefusal(tiny, request, "make it shorter (--slide); or, if metres were taken for millimetres, write the true");
    if (voxel_m == 5e-7) {
      expectRefusal(tiny, request,
                    "path slide length: 20 mm are 4e+04 voxels of 0.0005 mm, and the whole volume is 0.0605 mm long; ");
    }
    request.slide_length_m = 10 * voxel_m;
    request.press_depth_m = voxel_m;
    request.approach_m = 16001 * voxel_m;
    expectRefusal(tiny, request, "make it shorter (--approach)");
    request.approach_m = 16000 * voxel_m;
    EXPECT_EQ(buildTouchPath(tiny, request).approach_m, 16000 * voxel_m);
    request.approach_m = 5 * voxel_m;
    EXPECT_NEAR(buildTouchPath(tiny, request).slid_m, 10 * voxel_m, 1e-9 * voxel_m);
    request.press_depth_m = 122 * voxel_m;  // the volume is 121 long
    expectRefusal(tiny, request, "make it shorter (--depth)");
    request.press_depth_m = voxel_m;
    request.start_W = Vec3(0, 0, 31 * voxel_m);
    EXPECT_NEAR(buildTouchPath(tiny, request).start.p_W.norm(), 30 * voxel_m, 1e-3 * voxel_m);
  }
}

}  // namespace touch_path_test
}  // namespace palpate
