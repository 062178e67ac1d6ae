// SPDX-License-Identifier: Apache-2.0
#include "servo/algorithms/iso_field.hpp"

#include <random>

#include <gtest/gtest.h>

#include "support/sampled_volume.hpp"

namespace palpate {
namespace iso_field_test {

// Random densities: every cell holds a cubic of its own along a line, with walls of every thickness.
class RandomWindow {
 public:
  explicit RandomWindow(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> value(-1, 0.4F);
    held_.samples.resize(std::size_t{12} * 12 * 12);
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

// A random lattice of any spacing, turn and hand, with random densities.
class RandomLatticeWindow {
 public:
  explicit RandomLatticeWindow(Seeded& random) {
    SampleWindow& window = held_.window;
    window.size = Vec3i::Constant(7);
    window.version = 1;
    const Vec3 spacing_m(random.logBetween(0.3e-3, 5e-3), random.logBetween(0.3e-3, 5e-3),
                         random.logBetween(0.3e-3, 5e-3));
    window.lattice = latticeAround(random.inCube(0.1), window.size, spacing_m, random.axes(random.pick(2) == 1));
    held_.samples.resize(static_cast<std::size_t>(window.size.prod()));
    // Few samples above the isovalue make many thin walls; some windows are mostly object.
    const double highest = random.logBetween(0.02, 2);
    for (Sample& s : held_.samples) s.density = static_cast<float>(random.between(-1, highest));
    window.samples = held_.samples.data();
    // Some windows end with the volume.
    window.low_is_border = window.high_is_border = {random.pick(2) == 1, random.pick(2) == 1, random.pick(2) == 1};
  }
  [[nodiscard]] IsoField field() const { return {held_.window, 0}; }
  [[nodiscard]] const HeldWindow& held() const { return held_; }

 private:
  HeldWindow held_;
};

// Ways of every length, from a thousandth of a voxel to across the window, against a search in steps. What is above the
// isovalue by less than the roundings of seven float lerps of numbers up to 2 is neither a wall nor none.
TEST(IsoField, ForWaysOfEveryLengthTheFirstEntryIsThatOfASearchInSmallSteps) {
  constexpr double kRounding = 2e-6;
  constexpr int kSteps = 400;
  Seeded random(21);
  int entries = 0, none = 0, thin = 0, from_beyond = 0;
  for (int trial = 0; trial < 60000; ++trial) {
    const RandomLatticeWindow window(random);
    const IsoField field = window.field();
    const Vec3 from_L = Vec3::Constant(3) + random.inCube(trial % 4 == 0 ? 4.5 : 3);
    Vec3 to_L = from_L + random.direction() * random.logBetween(1e-3, 8);
    if (trial % 5 == 0) to_L[random.pick(3)] = std::round(from_L.x());  // ends on planes between cells
    const Probe from = field.probe(field.sampler().toWorld(from_L));
    const Probe to = field.probe(field.sampler().toWorld(to_L));
    if (from.side == Side::kUnknown || to.side == Side::kUnknown) continue;
    bool been_out = from.side == Side::kOutside;  // a way that begins inside comes in when it has been out
    const Vec3 way_W = to.p_W - from.p_W;
    int first = 0;  // seen inside
    int plain = 0;  // and so far that an entry, refined to 1e-4 of densities up to 2, is before it
    bool known = true;
    for (int i = 1; i <= kSteps; ++i) {
      const Probe here = field.probe(from.p_W + way_W * (static_cast<double>(i) / kSteps));
      known = known && here.side != Side::kUnknown;
      been_out = been_out || here.density < -kRounding;
      if (first == 0 && been_out && here.density > kRounding) first = i;
      if (plain == 0 && been_out && here.density > kRounding + 2e-4) plain = i;
    }
    if (!known) continue;
    const auto found = field.firstEntry(from, to);
    SCOPED_TRACE(testing::Message() << "trial " << trial << ", " << (to_L - from_L).norm() << " voxels");
    if (first == 0 && !found) {
      ++none;
      continue;
    }
    if (!found && from.side == Side::kInside) continue;  // out and in again within a third of a cell (iso_field.hpp)
    ASSERT_TRUE(found);                                  // a wall that the steps see
    ++entries;
    // It is on the way, and not later than what the steps see.
    const double share = way_W.dot(found->p_W - from.p_W) / way_W.squaredNorm();
    EXPECT_LT((from.p_W + way_W * share - found->p_W).norm(), 1e-9);
    EXPECT_GE(share, -1e-9);
    EXPECT_LE(share, plain > 0 ? (plain + 1e-6) / kSteps : 1 + 1e-9);
    EXPECT_LT((found->direction_W - way_W.normalized()).norm(), 1e-6);
    if (found->face.any()) {
      ++from_beyond;
      const Vec3 on_L = field.sampler().toIndex(found->p_W);
      EXPECT_NEAR(on_L[found->face.axis], found->face.high ? 6 : 0, 1e-6);
      continue;
    }
    // It is at the isovalue: to 1e-4 of the larger of the two densities around it, which are at most 2.
    EXPECT_NEAR(field.probe(found->p_W).density, 0, 2e-4 + kRounding);
    // What the steps do not see is thinner than a step: the density rises above the isovalue within one.
    if (first == 0 || share < (first - 1) / static_cast<double>(kSteps) - 1e-6) {
      ++thin;
      double above = -1;
      for (int i = 0; i <= 100; ++i) {
        above = std::max(above, field.probe(from.p_W + way_W * (share + i * 1.01e-2 / kSteps)).density);
      }
      EXPECT_GT(above, -kRounding);
    }
  }
  EXPECT_GT(entries, 1500);
  EXPECT_GT(none, 1500);
  EXPECT_GT(thin, 3);
  EXPECT_GT(from_beyond, 50);
}

// Within one cell the density along a way is a cubic. Where its maximum is between the ends, an isovalue just below it
// leaves a wall so thin that only the exact place of the maximum is in it. The margin is some fifty roundings.
TEST(IsoField, FindsTheTopOfACubicThatIsHardlyAboveTheIsovalue) {
  constexpr double kMargin = 1e-4;
  Seeded random(22);
  int tops = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const RandomLatticeWindow window(random);
    const IsoField field = window.field();
    const Vec3 cell_L(random.pick(6), random.pick(6), random.pick(6));
    const Vec3 half_L = Vec3::Constant(0.5);
    const Vec3 from_W = field.sampler().toWorld(cell_L + half_L + random.inCube(0.49));
    const Vec3 to_W = field.sampler().toWorld(cell_L + half_L + random.inCube(0.49));
    const auto density = [&](double t) { return field.probe(from_W + (to_W - from_W) * t).density; };
    constexpr int kSteps = 200;
    int top = 0;
    for (int i = 1; i <= kSteps; ++i) {
      if (density(static_cast<double>(i) / kSteps) > density(static_cast<double>(top) / kSteps)) top = i;
    }
    const double highest = density(static_cast<double>(top) / kSteps);
    if (std::max(density(0), density(1)) > highest - 10 * kMargin) continue;
    const IsoField thin(window.held().window, highest - kMargin);
    ASSERT_TRUE(thin.firstEntry(thin.probe(from_W), thin.probe(to_W))) << trial;
    const IsoField none(window.held().window, highest + kMargin);
    EXPECT_FALSE(none.firstEntry(none.probe(from_W), none.probe(to_W))) << trial;
    ++tops;
  }
  EXPECT_GT(tops, 1000);
}

// A wall whose top is on a plane of samples, between cells, where the density has a kink. Ways of less than a quarter
// of a voxel across it, anywhere along them: the cell on either side is a cubic, both together are none.
TEST(IsoField, FindsAWallBetweenTwoCellsOnTheShortestWays) {
  Seeded random(23);
  for (int trial = 0; trial < 3000; ++trial) {
    const int axis = random.pick(3);
    const AnalyticVolume volume =
        millimetreVolume([=](const Vec3& p_W) { return 1 - std::abs(p_W[axis] - 5e-3) / 1e-3; }, 11);
    static HeldWindow held[3];
    if (held[axis].samples.empty()) volume.hold(held[axis], Vec3i::Zero(), volume.size);
    Vec3 top_W = Vec3::Constant(5e-3) + random.inCube(2e-3);
    top_W[axis] = 5e-3;
    Vec3 way_W = random.direction() * random.logBetween(1e-3, 0.25) * 1e-3;
    // The ends are below the isovalue, the top is above.
    const double part = random.between(0.02, 0.98);
    const double lower = std::min(part, 1 - part) * std::abs(way_W[axis]) / 1e-3;
    if (lower < 1e-4) continue;
    const IsoField field(held[axis].window, 1 - random.between(0.05, 0.95) * lower);
    ASSERT_TRUE(field.firstEntry(field.probe(top_W - part * way_W), field.probe(top_W + (1 - part) * way_W))) << trial;
  }
}

// One sample above the isovalue makes a tent; a line beside the sample passes under its roof within one cell, where all
// ends of cells lie outside.
TEST(IsoField, SeesATentBetweenTheEndsOfACell) {
  HeldWindow held;
  held.samples.assign(std::size_t{8} * 8 * 8, Sample{0, 0, 0, -1});
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

// The same in each direction: 3.5 voxels from the one face, 11 or more from the volume's own.
TEST(IsoField, EveryAxisLeadsOutBothWays) {
  const Vec3 middle_W = Vec3::Constant(12e-3);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      HeldWindow held;
      millimetreVolume([=](const Vec3& p_W) { return side * (p_W[axis] - 12e-3) < 3.5e-3 ? 1.0 : -1.0; }, 24)
          .hold(held, Vec3i::Zero(), Vec3i::Constant(24));
      const IsoField field(held.window, 0);
      const auto way_out = field.nearestExit(field.probe(middle_W));
      ASSERT_TRUE(way_out);
      EXPECT_LT((way_out->p_W - middle_W - side * 3.5e-3 * Vec3::Unit(axis)).norm(), 1e-6) << axis << side;
      EXPECT_EQ(way_out->direction_W, Vec3(-side * Vec3::Unit(axis)));
      EXPECT_FALSE(way_out->face.any());
    }
  }
}

// Object that ends at the volume's faces only: the nearest of them, with its axis and end.
TEST(IsoField, ACutFaceIsAWayOut) {
  HeldWindow held;
  millimetreVolume([](const Vec3&) { return 1.0; }, 24).hold(held, Vec3i::Zero(), Vec3i::Constant(24));
  const IsoField field(held.window, 0);
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool high : {false, true}) {
      Vec3 from_W(11e-3, 12e-3, 11.5e-3);
      from_W[axis] = high ? 20e-3 : 2e-3;
      const auto way_out = field.nearestExit(field.probe(from_W));
      ASSERT_TRUE(way_out);
      EXPECT_EQ(way_out->face.axis, axis);
      EXPECT_EQ(way_out->face.high, high);
      Vec3 on_face_W = from_W;
      on_face_W[axis] = high ? 23e-3 : 0;
      EXPECT_LT((way_out->p_W - on_face_W).norm(), 1e-12);
    }
  }
}

// A wall of object from 10 to 14 mm, and ground below 4 mm. The window shows 2 to 25 mm. A plane at height z with its
// normal up: a HIP below it is in the air if both it and the place a quarter of a voxel above the plane are, and
// nothing is between.
TEST(IsoField, AHipInTheAirBehindAPlaneHasNoObjectInBetween) {
  const AnalyticVolume volume =
      millimetreVolume([](const Vec3& p_W) { return std::max(2e-3 - std::abs(p_W.z() - 12e-3), 4e-3 - p_W.z()); }, 32);
  HeldWindow held;
  volume.hold(held, Vec3i::Constant(2), Vec3i::Constant(24));
  const IsoField field(held.window, 0);
  const auto inAir = [&](double plane_mm, double hip_mm) {
    const auto at = [](double z_mm) { return Vec3(16e-3, 16e-3, z_mm * 1e-3); };
    return field.inAirBehind(at(plane_mm), Vec3::UnitZ(), field.probe(at(hip_mm)));
  };
  EXPECT_TRUE(inAir(9, 5));
  EXPECT_TRUE(inAir(24, 15));
  EXPECT_FALSE(inAir(15, 5));     // through the wall
  EXPECT_FALSE(inAir(15, 12));    // in the wall
  EXPECT_FALSE(inAir(9, 3));      // in the ground
  EXPECT_FALSE(inAir(9.85, 5));   // 0.1 mm above it the wall has begun
  EXPECT_TRUE(inAir(9.7, 5));     // 0.05 mm below the wall
  EXPECT_TRUE(inAir(13.8, 20));   // the place in front of the plane counts, not the plane
  EXPECT_FALSE(inAir(9, 1));      // nobody knows
  EXPECT_FALSE(inAir(24.9, 15));  // nor here
}

// All object as far as the window reaches, which is not known to end: no way out.
TEST(IsoField, ThereIsNoWayOutOfAWindowThatIsAllObject) {
  const AnalyticVolume volume = millimetreVolume([](const Vec3&) { return 1.0; }, 40);
  HeldWindow held;
  volume.hold(held, Vec3i::Constant(4), Vec3i::Constant(32));
  const IsoField field(held.window, 0);
  EXPECT_FALSE(field.nearestExit(field.probe(Vec3::Constant(20e-3))));
}

}  // namespace iso_field_test
}  // namespace palpate
