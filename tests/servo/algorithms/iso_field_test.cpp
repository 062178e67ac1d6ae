// SPDX-License-Identifier: Apache-2.0
#include "servo/algorithms/iso_field.hpp"

#include <random>

#include <gtest/gtest.h>

#include "support/analytic_volume.hpp"

namespace palpate {
namespace {

// Random densities: every cell holds a cubic of its own along a line, with walls of every thickness.
class RandomWindow {
 public:
  explicit RandomWindow(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> value(-1, 0.4F);
    held_.samples.resize(12 * 12 * 12);
    for (Sample& s : held_.samples) s.density = value(random);
    held_.window.lattice.spacing_m = Vec3::Constant(1e-3);
    held_.window.size = Vec3i::Constant(12);
    held_.window.version = 1;
    held_.window.samples = held_.samples.data();
  }
  [[nodiscard]] IsoField field() const { return {held_.window, 0}; }

 private:
  HeldWindow held_;
};

// Against a search in 2000 steps a way, which misses only what is thinner than a step.
TEST(IsoField, FindsTheFirstEntryHoweverThinTheWall) {
  int entries = 0;
  int between_samples = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const RandomWindow window(seed);
    const IsoField field = window.field();
    std::mt19937 random(seed + 1000);
    std::uniform_real_distribution<double> inside(0.2e-3, 10.8e-3);
    for (int trial = 0; trial < 20; ++trial) {
      const Probe from = field.probe(Vec3(inside(random), inside(random), inside(random)));
      const Probe to = field.probe(Vec3(inside(random), inside(random), inside(random)));
      if (from.side != Side::kOutside || (to.p_W - from.p_W).norm() < 1e-3) continue;
      const auto found = field.firstEntry(from, to);
      constexpr int kSteps = 2000;
      int first = 0;
      for (int i = 1; i <= kSteps && first == 0; ++i) {
        const Vec3 p_W = from.p_W + (to.p_W - from.p_W) * (static_cast<double>(i) / kSteps);
        if (field.probe(p_W).side == Side::kInside) first = i;
      }
      if (first == 0) {
        // What the steps do not see may still be there; then its place must be at the isovalue.
        if (found) {
          EXPECT_NEAR(field.probe(found->p_W).density, 0, 2e-3);
        }
        continue;
      }
      ASSERT_TRUE(found) << "seed " << seed << " trial " << trial;
      const double length_m = (to.p_W - from.p_W).norm();
      const double share = (found->p_W - from.p_W).norm() / length_m;
      // Not behind the first inside step; it may be before the step's beginning only in a wall thinner than a step.
      EXPECT_LE(share, (first + 1e-6) / kSteps);
      if (share < (first - 1.001) / kSteps) {
        EXPECT_NEAR(field.probe(found->p_W).density, 0, 2e-3);
        ++between_samples;
      }
      EXPECT_NEAR(field.probe(found->p_W).density, 0, 1e-2);
      ++entries;
    }
  }
  EXPECT_GT(entries, 300);
  EXPECT_LT(between_samples, entries / 10);
}

// One sample above the isovalue makes a tent; a line beside the sample passes under its roof within one cell, where all
// ends of cells lie outside.
TEST(IsoField, SeesATentBetweenTheEndsOfACell) {
  HeldWindow held;
  held.samples.assign(8 * 8 * 8, Sample{0, 0, 0, -1});
  held.samples[static_cast<std::size_t>(3 + 8 * (3 + 8 * 3))].density = 0.2F;
  held.samples[static_cast<std::size_t>(4 + 8 * (4 + 8 * 3))].density = 0.2F;
  held.window.lattice.spacing_m = Vec3::Constant(1e-3);
  held.window.size = Vec3i::Constant(8);
  held.window.version = 1;
  held.window.samples = held.samples.data();
  const IsoField field(held.window, -0.35);
  // Along the diagonal of the cell's bottom from one outside corner to the other: density -1 + 1.2 * 2 t (1 - t), whose
  // maximum -0.4 at t = 1/2 is outside; along the other diagonal it is -1 + 1.2 (1 - 2 t (1 - t)), above everywhere.
  const auto corner = [&](double i, double j) { return field.probe(Vec3(i, j, 3) * 1e-3); };
  EXPECT_FALSE(field.firstEntry(corner(4, 3), corner(3, 4)));
  const IsoField lower(held.window, -0.42);
  const auto entry = lower.firstEntry(lower.probe(Vec3(4e-3, 3e-3, 3e-3)), lower.probe(Vec3(3e-3, 4e-3, 3e-3)));
  ASSERT_TRUE(entry);
  // -1 + 2.4 t (1 - t) = -0.42: t = (1 - sqrt(1 - 4 * 0.58 / 2.4)) / 2; the search's 1e-4 of the peak's 0.02 above the
  // isovalue moves t by less than 1e-4.
  const double t = 0.5 * (1 - std::sqrt(1 - 4 * 0.58 / 2.4));
  EXPECT_NEAR(entry->p_W.x(), (4 - t) * 1e-3, 1e-4 * 1e-3);
}

// In a ball the nearest way out is along the radius: the gradient's. Its sag in the samples is h^2 / 8R an axis.
TEST(IsoField, TheNearestWayOutOfABallIsItsRadius) {
  const Vec3 centre_W = Vec3::Constant(19.7e-3);
  const AnalyticVolume volume = millimetreVolume(ball(centre_W, 14e-3), 40);
  HeldWindow held;
  volume.hold(held, Vec3i::Zero(), Vec3i::Constant(40));
  const IsoField field(held.window, 0);
  const Vec3 out_W = Vec3(1, 2, -0.5).normalized();
  const auto way_out = field.nearestExit(field.probe(centre_W + 9e-3 * out_W));
  ASSERT_TRUE(way_out);
  EXPECT_LT((way_out->p_W - (centre_W + 14e-3 * out_W)).norm(), 0.05e-3);
  EXPECT_LT((way_out->direction_W + out_W).norm(), 0.02);
  EXPECT_FALSE(way_out->face.any());
  EXPECT_FALSE(field.nearestExit(field.probe(centre_W + 15e-3 * out_W)));
}

// Flat inside, 3 voxels from one face and more from all others: there is no gradient, so an axis leads out.
TEST(IsoField, WithoutAGradientAnAxisLeadsOut) {
  const AnalyticVolume volume =
      millimetreVolume([](const Vec3& p_W) { return p_W.x() > 10.5e-3 && p_W.x() < 30.5e-3 ? 1.0 : -1.0; }, 40);
  HeldWindow held;
  volume.hold(held, Vec3i::Zero(), Vec3i::Constant(40));
  const IsoField field(held.window, 0);
  const auto low = field.nearestExit(field.probe(Vec3(14e-3, 20e-3, 20e-3)));
  ASSERT_TRUE(low);
  EXPECT_NEAR(low->p_W.x(), 10.5e-3, 1e-6);
  EXPECT_EQ(low->direction_W, Vec3::UnitX());
}

// All object as far as the window reaches, which is not known to end: no way out.
TEST(IsoField, ThereIsNoWayOutOfAWindowThatIsAllObject) {
  const AnalyticVolume volume = millimetreVolume([](const Vec3&) { return 1.0; }, 40);
  HeldWindow held;
  volume.hold(held, Vec3i::Constant(4), Vec3i::Constant(32));
  const IsoField field(held.window, 0);
  EXPECT_FALSE(field.nearestExit(field.probe(Vec3::Constant(20e-3))));
}

}  // namespace
}  // namespace palpate
