// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/strokes.hpp"

#include <gtest/gtest.h>

#include "oracle.hpp"

namespace palpate {
namespace strokes_test {

constexpr int kStrokes = 12;

// A ball as wide as a shell around the origin: holds whatever is in it, so an oracle for strokes through a shell.
std::vector<StrokeFigures> through(const char* wall, OracleErrors errors, bool thin) {
  const BenchVolume volume(wall);
  const std::unique_ptr<Phantom> body = makePhantom(thin ? "phantom:sphere?size=64" : wall);
  auto entrants = oneEntrant(std::make_unique<Oracle>(*body, std::move(errors)));
  StrokeRequest request;
  request.strokes = kStrokes;
  request.speeds_m_per_s = {0.1, 2};
  request.thin_wall = thin;
  return strokeFigures(volume, request, entrants, [](double) {}).front();
}

TEST(Strokes, WhoHoldsMissesNone) {
  for (const bool thin : {true, false}) {
    const auto figures = through(thin ? "phantom:shell?size=64&thickness=2" : "phantom:knot?size=64", {}, thin);
    ASSERT_EQ(figures.size(), 2U);
    for (const StrokeFigures& f : figures) {
      EXPECT_EQ(f.strokes + f.over_hole, kStrokes);
      EXPECT_EQ(f.missed, 0);
      EXPECT_EQ(f.lost, 0);
    }
    EXPECT_EQ(figures[0].speed_m_per_s, 0.1);
    EXPECT_EQ(figures[1].speed_m_per_s, 2);
  }
}

// Before each stroke: how many of all are done.
TEST(Strokes, TellHowFarTheyAre) {
  const BenchVolume volume("phantom:knot?size=64");
  const std::unique_ptr<Phantom> body = makePhantom("phantom:knot?size=64");
  auto entrants = oneEntrant(std::make_unique<Oracle>(*body, OracleErrors{}));
  StrokeRequest request;
  request.strokes = 2;
  request.speeds_m_per_s = {0.1, 2};
  std::vector<double> told;
  static_cast<void>(strokeFigures(volume, request, entrants, [&](double share) { told.push_back(share); }));
  EXPECT_EQ(told, (std::vector<double>{0, 0.25, 0.5, 0.75}));
}

TEST(Strokes, WhoFeelsNothingMissesAll) {
  for (const StrokeFigures& f :
       through("phantom:shell?size=64&thickness=2", {.blind = [](int, double) { return true; }}, true)) {
    EXPECT_EQ(f.missed, f.strokes);
    EXPECT_EQ(f.lost, 0);
  }
}

// The deepest place of a stroke of 16 mm at up to 45 degrees is 11 mm below or deeper.
TEST(Strokes, WhoLetsGoOnTheWayLosesAll) {
  const auto figures = through("phantom:shell?size=64&thickness=2",
                               {.blind = [](int, double depth_m) { return depth_m > 5e-3 && depth_m < 8e-3; }}, true);
  for (const StrokeFigures& f : figures) {
    EXPECT_EQ(f.missed, 0);
    EXPECT_EQ(f.lost, f.strokes);
  }
}

// Behind the force limit's 16 mm a stroke is not counted: the hand has won.
TEST(Strokes, WhatLiesBehindTheForceLimitDoesNotCount) {
  const auto figures =
      through("phantom:shell?size=64&thickness=2", {.blind = [](int, double d_m) { return d_m > 16e-3; }}, true);
  for (const StrokeFigures& f : figures) EXPECT_EQ(f.lost, 0);
}

// A wall of a tenth of a voxel is not in the samples at most places; nobody is blamed for it.
TEST(Strokes, OverHolesInTheSamplesAreLeftOut) {
  for (const StrokeFigures& f :
       through("phantom:shell?size=64&thickness=0.1", {.blind = [](int, double) { return true; }}, true)) {
    EXPECT_EQ(f.over_hole, kStrokes);
    EXPECT_EQ(f.strokes, 0);
    EXPECT_EQ(f.missed, 0);
  }
}

TEST(Strokes, OfTheDefaultAlgorithmIntoTwoVoxelsAreHeld) {
  const BenchVolume volume("phantom:shell?size=64&thickness=2");
  auto entrants = makeEntrants(volume, {5}).list;
  StrokeRequest request;
  request.strokes = 5;
  request.speeds_m_per_s = {1};
  request.thin_wall = true;
  const auto figures = strokeFigures(volume, request, entrants, [](double) {});
  ASSERT_EQ(entrants.front().algorithm, "hri");
  EXPECT_EQ(figures.front().front().missed + figures.front().front().lost, 0);
}

}  // namespace strokes_test
}  // namespace palpate
