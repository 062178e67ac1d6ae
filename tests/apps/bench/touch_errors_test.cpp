// SPDX-License-Identifier: Apache-2.0
// Errors that were put in by hand must come out. Truth: the sphere's exact distance; tolerances are rounding (1e-9) and
// what the level set is met to (1e-6 voxel).
#include "apps/bench/touch_errors.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "base/units.hpp"
#include "oracle.hpp"
#include "servo/safety/faults.hpp"

namespace palpate {
namespace touch_errors_test {

class TouchErrorsOf : public testing::Test {
 protected:
  [[nodiscard]] TouchErrors of(OracleErrors errors) const {
    auto entrants = oneEntrant(std::make_unique<Oracle>(volume_.phantom(), std::move(errors)));
    return touchErrors(volume_, path_, entrants, [](double) {}).front();
  }

  BenchVolume volume_{"phantom:sphere?size=64"};
  ContactPath path_ = contactPath(volume_, {.ticks = 500});
};

TEST_F(TouchErrorsOf, AnExactAlgorithmAreNone) {
  const TouchErrors errors = of({});
  EXPECT_EQ(errors.ticks, 470);
  EXPECT_EQ(errors.contact_ticks, 470);
  EXPECT_EQ(errors.vhip_voxel.count, 470U);
  EXPECT_LT(errors.vhip_voxel.max, 1e-9);
  EXPECT_LT(errors.force_percent.max, 1e-9);
  EXPECT_LT(errors.angle_deg.max, 1e-6);
  EXPECT_EQ(errors.missed_ticks, 0);
  EXPECT_EQ(errors.falls, 0);
  EXPECT_NEAR(errors.force_jump_max_N, errors.exact_force_jump_max_N, 1e-9);
  EXPECT_NEAR(errors.force_mean_N, 0.5, 1e-6);  // 1 mm at 500 N/m
  EXPECT_EQ(errors.fading_ticks, 0);
}

TEST_F(TouchErrorsOf, ALiftedVhipIsTheLift) {
  const TouchErrors errors = of({.lift_m = 0.2e-3});
  EXPECT_NEAR(errors.vhip_voxel.p50, 0.2, 1e-6);
  EXPECT_NEAR(of({.lift_m = -0.2e-3}).vhip_voxel.p99, 0.2, 1e-6);
  EXPECT_LT(errors.angle_deg.max, 1e-6);
}

TEST_F(TouchErrorsOf, AWrongForceIsThatShare) {
  EXPECT_NEAR(of({.force_share = 0.07}).force_percent.p50, 7, 1e-6);
  EXPECT_NEAR(of({.force_share = -0.07}).force_percent.p99, 7, 1e-6);
  EXPECT_NEAR(of({.force_share = 0.07}).force_off_max, 1.07, 1e-8);
  EXPECT_NEAR(of({.force_share = -0.07}).force_off_max, 1 / 0.93, 1e-8);
}

TEST_F(TouchErrorsOf, ATurnedForceIsThatAngle) {
  const TouchErrors errors = of({.turn_rad = 3 / kDegreesPerRadian});
  EXPECT_NEAR(errors.angle_deg.p50, 3, 1e-6);
  EXPECT_NEAR(errors.angle_deg.max, 3, 1e-6);
}

// Blind in two stretches of 10 and 5 ticks: two falls; the force of 0.5 N goes and comes at once.
TEST_F(TouchErrorsOf, LostContactIsCountedByTickAndByFall) {
  const TouchErrors errors =
      of({.blind = [](int tick, double) { return (tick >= 100 && tick < 110) || (tick >= 200 && tick < 205); }});
  EXPECT_EQ(errors.missed_ticks, 15);
  EXPECT_EQ(errors.falls, 2);
  EXPECT_EQ(errors.contact_ticks, 455);
  EXPECT_NEAR(errors.force_jump_max_N, 0.5, 1e-6);
  EXPECT_EQ(errors.force_jump_concave_max_N, 0);  // a sphere is nowhere concave
  EXPECT_LT(errors.exact_force_jump_max_N, 0.01);
}

// A knot is concave along some of the way. Blind for one tick in two, an algorithm loses its force everywhere.
TEST(TouchErrors, JumpsOnConcaveRegionsAreAmongAllJumps) {
  const BenchVolume volume("phantom:knot?size=64");
  const ContactPath path = contactPath(volume, {.ticks = 2000});
  auto entrants = oneEntrant(std::make_unique<Oracle>(
      volume.phantom(), OracleErrors{.blind = [](int tick, double) { return tick % 2 == 0; }}));
  const TouchErrors errors = touchErrors(volume, path, entrants, [](double) {}).front();
  EXPECT_NEAR(errors.force_jump_concave_max_N, 0.5, 0.1);  // some 1 mm at 500 N/m
  EXPECT_LE(errors.force_jump_concave_max_N, errors.force_jump_max_N);
}

// Three ticks with a fault that fades the force, seven with one that only limits it.
class Faulty final : public Algorithm {
 public:
  void reset(const Vec3&) noexcept override { tick_ = 0; }
  void tick(const TickInput&, TickOutput& out) noexcept override {
    out = TickOutput{};
    const int tick = tick_++;
    if (tick < 10) out.faults = bit(tick < 3 ? ServoFault::kNoWindow : ServoFault::kForceLimited);
  }

 private:
  int tick_ = 0;
};

TEST_F(TouchErrorsOf, TicksWithAFaultThatFadesAreCounted) {
  auto entrants = oneEntrant(std::make_unique<Faulty>());
  EXPECT_EQ(touchErrors(volume_, path_, entrants, [](double) {}).front().fading_ticks, 3);
}

TEST(TouchErrors, AMissIsAQuarterOfAVoxelAndFourDeviationsDeep) {
  EXPECT_EQ(missDepth_voxel(0), 0.25);
  EXPECT_EQ(missDepth_voxel(0.5), 2.25);
}

// 0.25 voxel below the surface is not yet missed.
TEST_F(TouchErrorsOf, AShallowBlindnessIsNotCounted) {
  EXPECT_EQ(of({.blind = [](int, double depth_m) { return depth_m < 0.2e-3; }}).missed_ticks, 0);
  EXPECT_GT(of({.blind = [](int, double depth_m) { return depth_m < 0.5e-3; }}).missed_ticks, 0);
}

// 24 voxels below the surface the tool is further from it than a window reaches: an algorithm that asks for the window
// at the surface must get it there, and one that does not, at the tool.
class Watches final : public Algorithm {
 public:
  Watches(const Phantom& phantom, bool at_surface) : phantom_(phantom), at_surface_(at_surface) {}
  void reset(const Vec3&) noexcept override {}
  void tick(const TickInput& in, TickOutput& out) noexcept override {
    const Vec3 place_W = wanted_ ? surface_W_ : in.hip_W;
    const Vec3 p_L = in.window->lattice.toIndex(place_W);
    if (p_L.minCoeff() < 9 || p_L.maxCoeff() > 32 - 9) ++outside;
    out = TickOutput{};
    const SurfaceOffset offset = phantom_.offset(in.hip_W);
    wanted_ = out.at_surface = at_surface_ && offset.distance_m < 0;
    surface_W_ = out.surface_W = in.hip_W - offset.distance_m * offset.normal;
  }
  int outside = 0;

 private:
  const Phantom& phantom_;
  bool at_surface_;
  bool wanted_ = false;
  Vec3 surface_W_ = Vec3::Zero();
};

TEST(TouchErrors, WindowsAreWhereTheAlgorithmWantsThem) {
  const BenchVolume volume("phantom:sphere?size=115&spacing=0.5mm");
  const ContactPath path = contactPath(volume, {.depth_voxel = 24, .ticks = 1000});
  std::vector<Entrant> entrants;
  std::vector<Watches*> watches;
  for (const bool at_surface : {false, true}) {
    auto watch = std::make_unique<Watches>(volume.phantom(), at_surface);
    watches.push_back(watch.get());
    entrants.push_back({"watches", 1, "none", std::move(watch), {}});
  }
  static_cast<void>(touchErrors(volume, path, entrants, [](double) {}));
  EXPECT_EQ(watches[0]->outside, 0);
  EXPECT_EQ(watches[1]->outside, 0);
}

TEST_F(TouchErrorsOf, AnAlgorithmThatShowsNoSurfaceHasNoErrorOfOne) {
  std::vector<Entrant> entrants = oneEntrant(std::make_unique<Oracle>(volume_.phantom(), OracleErrors{}));
  entrants.front().traits.shows_surface = false;
  const TouchErrors errors = touchErrors(volume_, path_, entrants, [](double) {}).front();
  EXPECT_EQ(errors.vhip_voxel.count, 0U);
  EXPECT_EQ(errors.force_percent.count, 0U);
  EXPECT_LT(errors.angle_deg.max, 1e-6);
  EXPECT_EQ(errors.contact_ticks, 470);
}

TEST_F(TouchErrorsOf, AnAlgorithmThatNeverTouchesHasNoErrorsButMisses) {
  const TouchErrors errors = of({.blind = [](int, double) { return true; }});
  EXPECT_EQ(errors.contact_ticks, 0);
  EXPECT_EQ(errors.vhip_voxel.count, 0U);
  EXPECT_EQ(errors.falls, 1);
  EXPECT_GE(errors.missed_ticks, 470);
}

// Each figure another number, so that no column can have that of its neighbour.
TEST(ErrorColumns, AreTheFiguresOfTheirNames) {
  TouchErrors errors;
  errors.ticks = 1;
  errors.contact_ticks = 2;
  errors.vhip_voxel = {1, 3, 0, 4, 0, 0};
  errors.force_percent = {1, 5, 0, 6, 0, 0};
  errors.force_off_max = 7;
  errors.angle_deg = {1, 8, 0, 9, 0, 10};
  errors.force_jump_max_N = 11;
  errors.exact_force_jump_max_N = 12;
  errors.missed_ticks = 13;
  errors.fading_ticks = 14;
  errors.falls = 15;
  BenchRow row;
  addFigures(row, errorColumns(), errors);
  const BenchRow expected = {{"ticks", std::int64_t{1}},
                             {"contact_ticks", std::int64_t{2}},
                             {"vhip_error_median_voxel", 3.0},
                             {"vhip_error_p99_voxel", 4.0},
                             {"force_error_median_percent", 5.0},
                             {"force_error_p99_percent", 6.0},
                             {"force_off_max", 7.0},
                             {"force_angle_median_deg", 8.0},
                             {"force_angle_p99_deg", 9.0},
                             {"force_angle_max_deg", 10.0},
                             {"force_jump_max_N", 11.0},
                             {"exact_force_jump_max_N", 12.0},
                             {"missed_ticks", std::int64_t{13}},
                             {"fading_fault_ticks", std::int64_t{14}},
                             {"fall_throughs", std::int64_t{15}}};
  EXPECT_EQ(row, expected);

  errors.vhip_voxel = errors.force_percent = Percentiles{};
  row.clear();
  addFigures(row, errorColumns(), errors);
  for (const char* none : {"vhip_error_median_voxel", "vhip_error_p99_voxel", "force_error_median_percent",
                           "force_error_p99_percent", "force_off_max"}) {
    EXPECT_TRUE(std::isnan(figureOf(row, none))) << none;
  }
  EXPECT_EQ(figureOf(row, "force_angle_max_deg"), 10);
}

}  // namespace touch_errors_test
}  // namespace palpate
