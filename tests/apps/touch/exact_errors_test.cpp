// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/exact_errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "apps/touch/force_error.hpp"

namespace palpate {
namespace exact_errors_test {

constexpr double kStiffness_N_per_m = 500;
constexpr double kVoxel_m = 1e-3;  // the sphere's voxels; its centre is the world's origin

double radius_m(const Phantom& sphere) {
  return -sphere.signedDistance_m(Vec3::Zero());
}

// The HIP below the surface on the x axis, the surface that was found `off_m` outside it, the force turned by
// `angle_deg` from the normal.
TickRecord touching(const Phantom& sphere, double time_s, double off_m, double angle_deg) {
  TickRecord record;
  record.time_s = time_s;
  record.in_contact = true;
  record.hip_W[0] = radius_m(sphere) - 1e-3;
  record.depth_m = 1e-3 + off_m;
  record.normal_W[0] = 1;
  record.vhip_W[0] = radius_m(sphere) + 7e-3;  // an effect has moved it
  record.force_W[0] = std::cos(angle_deg * std::numbers::pi / 180);
  record.force_W[2] = std::sin(angle_deg * std::numbers::pi / 180);
  return record;
}

class ExactErrorsTest : public testing::Test {
 protected:
  std::unique_ptr<Phantom> sphere_ = makePhantom("phantom:sphere?size=32");
};

TEST_F(ExactErrorsTest, AreDistanceInVoxelsAndAngleInDegrees) {
  const auto errors = exactErrors(*sphere_, {touching(*sphere_, 0, 0.25 * kVoxel_m, 3)}, {}, kStiffness_N_per_m);
  ASSERT_TRUE(errors);
  EXPECT_NEAR(errors->vhip_median_voxel.value_or(-1), 0.25, 1e-9);
  EXPECT_NEAR(errors->force_angle_median_deg, 3, 1e-9);
}

TEST_F(ExactErrorsTest, InsideCountsAsOutside) {
  EXPECT_NEAR(exactErrors(*sphere_, {touching(*sphere_, 0, -0.5 * kVoxel_m, -10)}, {}, kStiffness_N_per_m)
                  ->vhip_median_voxel.value_or(-1),
              0.5, 1e-9);
  EXPECT_NEAR(exactErrors(*sphere_, {touching(*sphere_, 0, -0.5 * kVoxel_m, -10)}, {}, kStiffness_N_per_m)
                  ->force_angle_median_deg,
              10, 1e-9);
}

// 1e-6 degrees is far below what an arc cosine could tell from 0 (its argument is then 1 - 1.5e-16).
TEST_F(ExactErrorsTest, SmallAnglesAreKept) {
  EXPECT_NEAR(exactErrors(*sphere_, {touching(*sphere_, 0, 0, 1e-6)}, {}, kStiffness_N_per_m)->force_angle_median_deg,
              1e-6, 1e-9);
  EXPECT_NEAR(exactErrors(*sphere_, {touching(*sphere_, 0, 0, 180)}, {}, kStiffness_N_per_m)->force_angle_median_deg,
              180, 1e-9);
}

TEST_F(ExactErrorsTest, VoxelsAreTheSmallestEdge) {
  const auto flat = makePhantom("phantom:sphere?size=32&spacing=1x1x4mm");
  EXPECT_NEAR(
      exactErrors(*flat, {touching(*flat, 0, 0.25e-3, 0)}, {}, kStiffness_N_per_m)->vhip_median_voxel.value_or(-1),
      0.25, 1e-9);
}

TEST_F(ExactErrorsTest, CountTheSlideOnly) {
  const std::vector<PathPhase> phases = {{"approach", 0, 1}, {"slide", 1, 2}, {"retreat", 2, 3}};
  const std::vector<TickRecord> records = {touching(*sphere_, 0.5, 5e-3, 90), touching(*sphere_, 1.5, 0, 1),
                                           touching(*sphere_, 2.5, 5e-3, 90)};
  EXPECT_NEAR(exactErrors(*sphere_, records, phases, kStiffness_N_per_m)->vhip_p99_voxel.value_or(-1), 0, 1e-9);
  EXPECT_NEAR(exactErrors(*sphere_, records, phases, kStiffness_N_per_m)->force_angle_p99_deg, 1, 1e-9);
  EXPECT_NEAR(exactErrors(*sphere_, records, {}, kStiffness_N_per_m)->vhip_p99_voxel.value_or(-1), 5,
              1e-9);  // a path of no phases: all of it
}

// A hundred ticks, n of them with n half degrees and n hundredths of a voxel at most: the 50th and the 99th. The
// slide's first and last instant belong to it; an instant more does not.
TEST_F(ExactErrorsTest, AreTheMedianAndThe99thPercentileOfTheSlide) {
  std::vector<TickRecord> records = {touching(*sphere_, std::nextafter(1.0, 0.0), 5e-3, 90),
                                     touching(*sphere_, std::nextafter(2.0, 3.0), 5e-3, 90)};
  for (int n = 1; n <= 100; ++n)
    records.push_back(touching(*sphere_, n == 1 ? 1 : n == 100 ? 2 : 1.5, 0.01 * n * kVoxel_m, 0.5 * n));
  const auto errors =
      exactErrors(*sphere_, records, {{"press", 0, 1}, {"slide", 1, 2}, {"retreat", 2, 3}}, kStiffness_N_per_m);
  ASSERT_TRUE(errors);
  EXPECT_TRUE(errors->slide_only);
  EXPECT_EQ(errors->ticks, 100);
  EXPECT_NEAR(errors->force_angle_median_deg, 25, 1e-9);
  EXPECT_NEAR(errors->force_angle_p99_deg, 49.5, 1e-9);
  EXPECT_NEAR(errors->vhip_median_voxel.value_or(-1), 0.5, 1e-9);
  EXPECT_NEAR(errors->vhip_p99_voxel.value_or(-1), 0.99, 1e-9);
}

TEST_F(ExactErrorsTest, CountAllContactWhereTheSlideHasNone) {
  const std::vector<PathPhase> phases = {{"press", 0, 1}, {"slide", 1, 2}};
  const auto errors =
      exactErrors(*sphere_, {touching(*sphere_, 0.4, 0, 2), touching(*sphere_, 0.5, 0, 2)}, phases, kStiffness_N_per_m);
  ASSERT_TRUE(errors);
  EXPECT_FALSE(errors->slide_only);
  EXPECT_EQ(errors->ticks, 2);
  EXPECT_TRUE(exactErrors(*sphere_, {touching(*sphere_, 1.4, 0, 2)}, phases, kStiffness_N_per_m)->slide_only);
}

TEST_F(ExactErrorsTest, LeaveOutWhatThePassivityControllerAdds) {
  TickRecord damped = touching(*sphere_, 0, 0, 60);
  damped.damped = true;
  EXPECT_FALSE(exactErrors(*sphere_, {damped}, {}, kStiffness_N_per_m));
  EXPECT_NEAR(exactErrors(*sphere_, {damped, touching(*sphere_, 0, 0, 2)}, {}, kStiffness_N_per_m)->force_angle_p99_deg,
              2, 1e-9);
}

// The force is known, a surface is not.
TEST_F(ExactErrorsTest, HaveNoDistanceForAnAlgorithmWithoutASurface) {
  TickRecord record = touching(*sphere_, 0, 0, 2);
  record.depth_m = std::numeric_limits<double>::quiet_NaN();
  record.vhip_W[0] = record.hip_W[0];
  const auto errors = exactErrors(*sphere_, {record}, {}, kStiffness_N_per_m);
  ASSERT_TRUE(errors);
  EXPECT_FALSE(errors->vhip_median_voxel || errors->vhip_p99_voxel);
  EXPECT_NEAR(errors->force_angle_median_deg, 2, 1e-9);
}

// A wall of 4 mm, pressed from outside beyond its middle: the surface nearest to the HIP is the inner one, whose normal
// is the opposite. The force is right by the one that is touched.
TEST_F(ExactErrorsTest, OfAThinWallAreOfTheSideInTouch) {
  const auto shell = makePhantom("phantom:shell?size=64&thickness=4");
  double outer_m = 32e-3;
  while (shell->signedDistance_m(Vec3(outer_m, 0, 0)) > 0) outer_m -= 1e-5;
  for (const double depth_m : {1e-3, 1.9e-3, 2.1e-3, 3e-3}) {
    TickRecord record;
    record.in_contact = true;
    record.hip_W[0] = outer_m - depth_m;
    record.vhip_W[0] = outer_m;
    record.normal_W[0] = 1;
    record.depth_m = depth_m;
    record.force_W[0] = 1;
    EXPECT_NEAR(exactErrors(*shell, {record}, {}, kStiffness_N_per_m)->force_angle_median_deg, 0, 1e-6) << depth_m;
    record.force_W[0] = -1;
    EXPECT_NEAR(exactErrors(*shell, {record}, {}, kStiffness_N_per_m)->force_angle_median_deg, 180, 1e-6) << depth_m;
  }
}

// Friction may hold the VHIP back: the normal is that under the HIP, here 20 degrees further on the ball.
TEST_F(ExactErrorsTest, AnglesAreToTheNormalAtTheHip) {
  TickRecord record = touching(*sphere_, 0, 0, 0);
  const double turn = 20 * std::numbers::pi / 180;
  record.hip_W[0] = (radius_m(*sphere_) - 1e-3) * std::cos(turn);
  record.hip_W[1] = (radius_m(*sphere_) - 1e-3) * std::sin(turn);
  EXPECT_NEAR(exactErrors(*sphere_, {record}, {}, kStiffness_N_per_m)->force_angle_median_deg, 20, 1e-9);
}

TEST_F(ExactErrorsTest, LeaveOutWhatIsNoContact) {
  TickRecord free = touching(*sphere_, 0, 5e-3, 90);
  free.in_contact = false;
  TickRecord gated = touching(*sphere_, 0, 5e-3, 90);  // in contact, but the safety gate let no force through
  std::fill(std::begin(gated.force_W), std::end(gated.force_W), 0.0);
  EXPECT_FALSE(exactErrors(*sphere_, {free, gated}, {}, kStiffness_N_per_m));
  EXPECT_FALSE(exactErrors(*sphere_, {}, {}, kStiffness_N_per_m));
  EXPECT_NEAR(
      exactErrors(*sphere_, {free, gated, touching(*sphere_, 0, 0, 2)}, {}, kStiffness_N_per_m)->force_angle_p99_deg, 2,
      1e-9);
}

// The sphere's surface point over the HIP is known: K times the distance to it, which counts a wrong depth and a wrong
// direction alike. Doubles of a few centimetres round by 1e-17 m, times 500 N/m.
TEST_F(ExactErrorsTest, ForceErrorIsStiffnessTimesTheVectorBetweenTheSurfacePoints) {
  const auto deeper = exactErrors(*sphere_, {touching(*sphere_, 0, 0.25e-3, 0)}, {}, 800);
  EXPECT_NEAR(deeper->force_error_median_N.value_or(-1), 800 * 0.25e-3, 1e-9);
  TickRecord turned = touching(*sphere_, 0, 0, 0);  // the right depth, along a normal that is 10 degrees off
  const double turn = 10 * std::numbers::pi / 180;
  turned.normal_W[0] = std::cos(turn);
  turned.normal_W[1] = std::sin(turn);
  const auto errors = exactErrors(*sphere_, {turned}, {}, 800);
  EXPECT_NEAR(errors->force_error_p99_N.value_or(-1), 800 * 2 * std::sin(turn / 2) * 1e-3, 1e-9);
}

// Two ticks of the slide: one felt right, one 1 mm deep without contact, which errs by the whole force. What is before
// the slide does not count.
TEST_F(ExactErrorsTest, ForceErrorCountsLostContact) {
  TickRecord lost = touching(*sphere_, 1.5, 0, 0), early = lost;
  lost.in_contact = early.in_contact = false;
  lost.depth_m = early.depth_m = 0;
  early.time_s = 0.5;
  early.hip_W[0] -= 5e-3;
  const std::vector<PathPhase> phases = {{"press", 0, 1}, {"slide", 1, 2}};
  const auto errors = exactErrors(*sphere_, {early, touching(*sphere_, 1.2, 0, 0), lost}, phases, 800);
  EXPECT_NEAR(errors->force_error_p99_N.value_or(-1), 800 * 1e-3, 1e-9);
  EXPECT_EQ(errors->ticks, 1);
}

// The HIP is 0.2 mm outside, and a depth of 0.3 mm was found.
TEST_F(ExactErrorsTest, ForceErrorCountsContactThatShouldNotBe) {
  TickRecord record = touching(*sphere_, 0, 0, 0);
  record.hip_W[0] = radius_m(*sphere_) + 0.2e-3;
  record.depth_m = 0.3e-3;
  EXPECT_NEAR(exactErrors(*sphere_, {record}, {}, 800)->force_error_p99_N.value_or(-1), 800 * 0.3e-3, 1e-9);
}

TEST_F(ExactErrorsTest, ForceErrorIsLeftOutWhereTheSurfacePointIsNotKnown) {
  TickRecord none = touching(*sphere_, 0, 0, 2);  // an algorithm without a surface
  none.depth_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(exactErrors(*sphere_, {none}, {}, 800)->force_error_p99_N);
  TickRecord across = touching(*sphere_, 0, 0, 0);  // as on the far side of a wall
  across.normal_W[0] = -1;
  EXPECT_FALSE(exactErrors(*sphere_, {across}, {}, 800)->force_error_p99_N);
}

// With K = 1000 N/m a row's factor of 1.5 is the largest.
TEST(SpringStiffness, IsTheLargestThatTheDensityGives) {
  Scene scene;
  scene.stiffness_N_per_m = 1000;
  EXPECT_EQ(springStiffness(scene), 1000);
  scene.stiffness_density = {{0, 0.5}, {100, 1.5}, {200, 1}};
  EXPECT_EQ(springStiffness(scene), 1500);
}

TEST_F(ExactErrorsTest, DoNotExistWithoutASurface) {
  EXPECT_FALSE(
      exactErrors(*makePhantom("phantom:random?size=8"), {touching(*sphere_, 0, 0, 0)}, {}, kStiffness_N_per_m));
}

}  // namespace exact_errors_test
}  // namespace palpate
