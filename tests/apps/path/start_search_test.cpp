// SPDX-License-Identifier: Apache-2.0
// Bodies whose best place is plain to see.
#include "apps/path/start_search.hpp"

#include <array>

#include <gtest/gtest.h>

#include "apps/path/touch_path.hpp"
#include "base/error.hpp"
#include "grid_field.hpp"

namespace palpate {
namespace start_search_test {

// A cube of 17 mm with a plate 2 mm away from each of the faces that are covered, and 5 mm of approach asked for. The
// tool comes from above, else from the front, else from the sides (-x, then +x), from behind, from below: to the middle
// of the first face that is not covered.
TEST(StartSearch, ComesFromTheMostNaturalSideThatIsFree) {
  const Vec3 centre(3e-3, -2e-3, 1e-3);
  const std::array<Vec3, 6> out = {Vec3::UnitZ(), -Vec3::UnitY(), -Vec3::UnitX(),
                                   Vec3::UnitX(), Vec3::UnitY(),  -Vec3::UnitZ()};
  for (std::size_t covered = 0; covered < out.size(); ++covered) {
    const GridField field(Vec3i::Constant(49), Vec3::Constant(1e-3), [&](const Vec3& p) {
      double inside = boxDistance(p - centre, Vec3::Constant(8.5e-3));
      for (std::size_t i = 0; i < covered; ++i) {
        const Vec3 half = Vec3::Constant(9.5e-3) - 8.5e-3 * out[i].cwiseAbs();
        inside = std::max(inside, boxDistance(p - centre - 11.5e-3 * out[i], half));
      }
      return 1e3 * inside;
    });
    const ObjectPieces pieces(field);
    const auto start = startOn(field, pieces, 0, std::nullopt, 5e-3);
    ASSERT_TRUE(start);
    EXPECT_LT((start->p_W - centre - 8.5e-3 * out[covered]).norm(), 1e-8) << covered;
    EXPECT_LT((start->normal_W - out[covered]).norm(), 1e-6) << covered;
  }
}

// A wire frame, and under it a ball, which is the smaller piece. Samples are a millimetre apart, so the surface of the
// ball lies up to 3/8 h^2 / R = 0.09 mm under the formula's.
const Vec3 kBall(0, 0, -10e-3);
GridField frameAndBall() {
  return {Vec3i::Constant(41), Vec3::Constant(1e-3), [](const Vec3& p) {
            const double wire =
                1.5e-3 - std::max(std::abs(p.head<2>().cwiseAbs().maxCoeff() - 15e-3), std::abs(p.z() - 10e-3));
            return 1e3 * std::max(wire, 4.3e-3 - (p - kBall).norm());
          }};
}

// From above all rays go through the frame; nothing says that they may come from elsewhere.
TEST(StartSearch, KeepsToTheWishedDirection) {
  const GridField field = frameAndBall();
  const ObjectPieces pieces(field);
  EXPECT_FALSE(startOn(field, pieces, 0, -Vec3::UnitZ(), 5e-3));
  const auto beside = startOn(field, pieces, 0, std::nullopt, 5e-3);
  ASSERT_TRUE(beside);
  EXPECT_EQ(pieces.pieceAt(beside->p_W), 0U);
  const auto on_ball = startOn(field, pieces, 1, -2 * Vec3::UnitZ(), 5e-3);
  ASSERT_TRUE(on_ball);
  EXPECT_NEAR((on_ball->p_W - kBall).norm(), 4.3e-3, 0.1e-3);
}

// The lengths are those of the piece that is touched. Nine samples across, the ball is 9 mm, and the slide is 0.7 of
// that.
TEST(StartSearch, ThePathFitsThePieceItBeginsOn) {
  const GridField field = frameAndBall();
  PathRequest from_above, near;
  from_above.toward_W = -Vec3::UnitZ();
  near.start_W = Vec3(0, 0, -5.2e-3);
  for (const PathRequest& request : {from_above, near}) {
    const TouchPath path = buildTouchPath(field, request);
    EXPECT_NEAR((path.start.p_W - kBall).norm(), 4.3e-3, 0.1e-3);
    EXPECT_NEAR(path.slid_m, 6.3e-3, 1e-12);
  }
}

std::string refusalOf(double half_m, double voxel_m) {
  const AnalyticField ball([&](const Vec3& p) { return sphereDistance(p, half_m / 2); }, half_m, voxel_m);
  try {
    (void)startNear(ball, Vec3(0.5, -0.25, 0.125));
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

// 20 mm or 20 voxels, whichever is more, but no farther than the volume is long: 5 voxels of 0.5 mm along each axis.
TEST(StartSearch, SaysHowFarItLookedForAWishedStart) {
  const auto words = [](const std::string& reach_mm) {
    return "path start: no surface at isovalue 0 within " + reach_mm +
           " mm of (500, -250, 125) mm; give a point nearer to the surface or another isovalue";
  };
  EXPECT_EQ(refusalOf(30e-3, 0.5e-3), words("20"));
  EXPECT_EQ(refusalOf(60e-3, 2e-3), words("40"));
  EXPECT_EQ(refusalOf(1e-3, 0.5e-3), words("4.33013"));
}

}  // namespace start_search_test
}  // namespace palpate
