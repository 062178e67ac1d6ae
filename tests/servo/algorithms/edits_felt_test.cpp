// SPDX-License-Identifier: Apache-2.0
// Edits are felt gently by every algorithm of the registry that feels edits: what an edit adds comes in over time
// (edit_ease.hpp), what it takes away is gone in the tick that reads the new window.
//
// Algorithms on a mesh are left out: the program refuses edits for them. hri-paper and hri-paper-line are the paper to
// the letter: they look at the volume when their counter is up and then feel an edit whole at once, and a free tool
// that was buried feels nothing until it has been outside.
#include <algorithm>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "servo/contact/edit_ease.hpp"
#include "servo/devices/hand_dynamics.hpp"
#include "servo/objects/shapes.hpp"
#include "support/algorithm_driver.hpp"
#include "support/algorithm_setups.hpp"
#include "support/seeded.hpp"

namespace palpate {
namespace edits_felt_test {

constexpr double kVoxel = 1e-3;
constexpr int kSide = 40;
constexpr double kEaseTicks = 500;
constexpr double kStiffness = 500;
constexpr double kContrast = 8e-3;      // haptization's table: 3 N from 4 mm of distance density on, 750 N/m below
constexpr double kTableForce_N = 3;     // its largest
constexpr double kAvilaDeepest = 3e-3;  // [m]
// VhipAlgorithm::kSamePlane: planes that differ by less are one; as a force.
constexpr double kSamePlane_N = kStiffness * 0.02 * kVoxel;
const Vec3 kAt(19.4e-3, 20.7e-3, 20e-3);  // [m]

AnalyticVolume layer(double top_m) {
  return millimetreVolume([=](const Vec3& p_W) { return top_m - p_W.z(); }, kSide);
}

Vec3 height(double z_m) {
  return {kAt.x(), kAt.y(), z_m};
}

class EditsFelt : public testing::TestWithParam<std::string> {
 protected:
  [[nodiscard]] std::unique_ptr<Algorithm> make(int n = 1) const {
    return makeFor(GetParam(), {.stiffness_N_per_m = kStiffness, .damping_Ns_per_m = 0, .plane_renewal_ticks = n},
                   layer(20e-3), kContrast);
  }
  [[nodiscard]] bool is(std::string_view name) const { return GetParam() == name; }
  [[nodiscard]] bool isPaper() const { return is("hri-paper") || is("hri-paper-line"); }
  [[nodiscard]] bool hasVhip() const { return !is("avila") && !is("haptization"); }
  // The most that a tick may add, where an edit has made the contact deeper by `added_m`: its share of the force that
  // the edit added. A table gives no more than its largest force, avila K times its deepest.
  [[nodiscard]] double share_N(double added_m) const {
    if (is("haptization")) return std::min(kTableForce_N, 2 * kTableForce_N / kContrast * added_m) / kEaseTicks;
    if (is("avila")) added_m = std::min(added_m, kAvilaDeepest);
    return kStiffness * added_m / kEaseTicks;
  }
};

// The force at `hip_W` of a tool that came there from outside, without any edit.
double trueForce(std::unique_ptr<Algorithm> algorithm, const AnalyticVolume& volume, const Vec3& hip_W) {
  const Vec3 start_W = height(35e-3);
  AlgorithmDriver driver(*algorithm, volume, start_W, kSide);
  driver.follow = false;
  driver.at(start_W);
  driver.stroke(hip_W, 100);
  return driver.stroke(hip_W, 5).back().force_W.z();
}

// Holds the tool after an edit: no tick may add more than `most_N`, none takes away, and after kEaseTicks all is there.
// Gives the largest step.
double expectEven(AlgorithmDriver& driver, const Vec3& hip_W, double from_N, double most_N, double to_N) {
  double last_N = from_N;
  double largest_N = 0;
  for (int i = 0; i < static_cast<int>(kEaseTicks) + 3; ++i) {
    const double force_N = driver.at(hip_W).force_W.z();
    largest_N = std::max(largest_N, force_N - last_N);
    EXPECT_GE(force_N - last_N, -kSamePlane_N) << i;
    last_N = force_N;
  }
  EXPECT_LE(largest_N, most_N);
  EXPECT_NEAR(last_N, to_N, kSamePlane_N);
  return largest_N;
}

// At rest 1 mm below the surface, a layer is put over it. Densities are exact, so only the float samples round: 1e-6 N.
TEST_P(EditsFelt, ALayerOverAToolAtRestComesInEvenly) {
  for (const double added_m : {0.3e-3, 0.9e-3, 2e-3, 7e-3}) {
    SCOPED_TRACE(added_m);
    const AnalyticVolume before = layer(20e-3);
    const AnalyticVolume after = layer(20e-3 + added_m);
    const auto algorithm = make();
    AlgorithmDriver driver(*algorithm, before, height(22e-3), kSide);
    driver.follow = false;
    driver.at(height(22e-3));
    const Vec3 hip_W = height(19e-3);
    driver.stroke(hip_W, 30);
    const double before_N = driver.stroke(hip_W, 3).back().force_W.z();
    ASSERT_GT(before_N, 0.2);
    driver.edit(after);
    if (isPaper()) {
      driver.at(hip_W);  // n = 1: the counter is up in the tick after next at the latest
      EXPECT_NEAR(driver.at(hip_W).force_W.z(), before_N + kStiffness * added_m, kSamePlane_N);
      continue;
    }
    const double step_N = expectEven(driver, hip_W, before_N, share_N(added_m) + 1e-6, trueForce(make(), after, hip_W));
    RecordProperty(fmt::format("step when {:g} mm are put over it, mN", 1e3 * added_m),
                   fmt::format("{:.3g}", 1e3 * step_N));
  }
}

// A free tool is buried 2.5 mm deep.
TEST_P(EditsFelt, MaterialAroundAFreeToolComesInEvenly) {
  const AnalyticVolume before = layer(15e-3);
  const AnalyticVolume after = layer(22.5e-3);
  const auto algorithm = make();
  AlgorithmDriver driver(*algorithm, before, height(20e-3), kSide);
  driver.follow = false;
  driver.at(height(20e-3));
  driver.edit(after);
  if (isPaper()) {
    for (int i = 0; i < 600; ++i) ASSERT_TRUE(driver.at(height(20e-3)).force_W.isZero(0));
    return;
  }
  expectEven(driver, height(20e-3), 0, share_N(2.5e-3) + 1e-6, trueForce(make(), after, height(20e-3)));
}

// The window has to be at the surface, not at what is shown of it.
TEST_P(EditsFelt, SamplesAreAskedForAtTheTrueSurface) {
  if (!hasVhip()) return;
  const AnalyticVolume before = layer(18e-3);
  const AnalyticVolume after = layer(24e-3);
  const auto algorithm = make();
  AlgorithmDriver driver(*algorithm, before, height(19e-3), kSide);
  driver.follow = false;
  driver.at(height(19e-3));
  driver.stroke(height(17e-3), 20);
  driver.edit(after);
  for (int i = 0; i < 3; ++i) {
    const TickOutput out = driver.at(height(17e-3));
    if (isPaper() && i < 2) continue;  // until its counter is up
    ASSERT_TRUE(out.at_surface);
    EXPECT_NEAR(out.surface_W.z(), 24e-3, 0.01 * kVoxel);
    EXPECT_NEAR(out.vhip_W.z(), isPaper() ? 24e-3 : 18e-3, 3 * 6e-3 / kEaseTicks + 0.02 * kVoxel);
  }
}

// In a slide on a ball that grows under the tool: no step exceeds those that the slide has without edits, on the small
// ball and on the grown one, by more than the edit's share and what a plane is not told from another by: the tool goes
// w = 0.1 mm a tick, w^2 / 8 of a voxel's way aside. The paper's modes feel the whole of it in one step.
TEST_P(EditsFelt, AddsNoStepToASlide) {
  const auto grown = [](double by_m) { return millimetreVolume(ball(kAt, 12e-3 + by_m), kSide); };
  const auto place = [](int tick) {
    const double angle = 0.1e-3 / 11e-3 * tick;
    return Vec3(kAt + 11e-3 * Vec3(std::sin(angle), 0, std::cos(angle)));
  };
  constexpr int kTicks = 200;
  const auto slide = [&](const AnalyticVolume& first, const AnalyticVolume& second, int edit_at) {
    const auto algorithm = make();
    AlgorithmDriver driver(*algorithm, first, kAt + Vec3(0, 0, 17e-3), kSide);
    driver.follow = false;
    driver.at(kAt + Vec3(0, 0, 17e-3));
    driver.stroke(place(0), 60);
    Vec3 last_W = driver.stroke(place(0), 5).back().force_W;
    double largest_N = 0;
    for (int tick = 1; tick <= kTicks; ++tick) {
      if (tick == edit_at) driver.edit(second);
      const Vec3 force_W = driver.at(place(tick)).force_W;
      largest_N = std::max(largest_N, (force_W - last_W).norm());
      last_W = force_W;
    }
    EXPECT_GT(last_W.norm(), 0.2);
    return largest_N;
  };
  const AnalyticVolume small = grown(0);
  for (const double by_m : {0.5e-3, 2e-3}) {
    const AnalyticVolume large = grown(by_m);
    const double own_N = std::max(slide(small, small, -1), slide(large, large, -1));
    const double unfelt_N = hasVhip() ? kSamePlane_N + kStiffness * 0.1e-3 * 0.1e-3 / (8 * kVoxel) : 0;
    const double edited_N = slide(small, large, 50);
    EXPECT_LE(edited_N, own_N + (isPaper() ? kStiffness * by_m : share_N(by_m)) + unfelt_N) << by_m;
    if (isPaper()) {
      EXPECT_GE(edited_N, kStiffness * by_m - own_N - unfelt_N) << by_m;
    }
    RecordProperty(fmt::format("step when {:g} mm grow, mN", 1e3 * by_m),
                   fmt::format("{:.3g}, of its own {:.3g}", 1e3 * edited_N, 1e3 * own_N));
  }
}

// Buried D deep in the hand of somebody who lets it go, or who holds it where it is. What is shown of the depth grows
// with u = D / 0.5 s, less the tool's way, so without any damping the tool follows a ramp: x' = u (1 - cos wt) <= 2 u.
// A hand that holds it back makes it slower. Shown at once, D would throw it with D sqrt(K / m): 14 times that.
TEST_P(EditsFelt, ABuriedToolComesOutAndIsNotThrown) {
  constexpr double kDeep = 2.5e-3;
  const double bound_m_per_s = 2 * kDeep / EditEase::kTime_s;
  for (const double hand_N_per_m : {0.0, 400.0}) {
    SCOPED_TRACE(hand_N_per_m);
    const HandParameters hand{.hand_stiffness_N_per_m = hand_N_per_m};
    const HandDynamics dynamics(hand, 1e-3);
    ASSERT_GT(kDeep * std::sqrt(kStiffness / (hand.hand_mass_kg + hand.device_mass_kg)), 10 * bound_m_per_s);
    const AnalyticVolume before = layer(15e-3);
    const AnalyticVolume after = layer(20e-3 + kDeep);
    const auto algorithm = make();
    const Vec3 held_W = height(20e-3);
    AlgorithmDriver driver(*algorithm, before, held_W, kSide);
    driver.follow = false;
    driver.at(held_W);
    driver.edit(after);
    HandDynamics::State state{held_W, Vec3::Zero()};
    double fastest_m_per_s = 0;
    for (int tick = 0; tick < 3000; ++tick) {
      const Vec3 force_W = driver.at(state.position_W).force_W;
      state = dynamics.step(state, held_W, held_W, force_W);
      fastest_m_per_s = std::max(fastest_m_per_s, state.velocity_W.norm());
    }
    EXPECT_LE(fastest_m_per_s, bound_m_per_s);
    RecordProperty(hand_N_per_m == 0 ? "let go, mm/s" : "held, mm/s", fmt::format("{:.3g}", 1e3 * fastest_m_per_s));
    const double out_m = state.position_W.z() - held_W.z();
    if (isPaper()) {
      EXPECT_NEAR(out_m, 0, 1e-12);  // rounding of the hand
    } else if (hand_N_per_m == 0) {
      // Free of the surface the mass coasts at most x' m / b.
      const double coasts_m = bound_m_per_s * (hand.hand_mass_kg + hand.device_mass_kg) /
                              (hand.hand_damping_Ns_per_m + hand.device_damping_Ns_per_m);
      EXPECT_GE(out_m, 0.98 * kDeep);
      EXPECT_LE(out_m, kDeep + coasts_m);
    } else {  // where the two springs balance
      const double surface_N_per_m = is("haptization") ? 2 * kTableForce_N / kContrast : kStiffness;
      EXPECT_NEAR(out_m, kDeep * surface_N_per_m / (surface_N_per_m + hand_N_per_m), 0.02 * kDeep);
    }
    EXPECT_LT(state.velocity_W.norm(), 1e-4);
  }
}

// n = 1000: the plane would be renewed a second later. hri-paper waits for its counter, two ticks at n = 1.
TEST_P(EditsFelt, ARemovedSurfaceLetsGoInTheTickThatReadsTheWindow) {
  const AnalyticVolume before = layer(20e-3);
  const AnalyticVolume nothing = millimetreVolume([](const Vec3&) { return -20e-3; }, kSide);
  const AnalyticVolume lower = layer(19.5e-3);
  const Vec3 hip_W = height(19e-3);
  const int n = isPaper() ? 1 : 1000;
  for (const AnalyticVolume* after : {&nothing, &lower}) {
    const auto algorithm = make(n);
    AlgorithmDriver driver(*algorithm, before, height(22e-3), kSide);
    driver.follow = false;
    driver.at(height(22e-3));
    driver.stroke(hip_W, 30);
    ASSERT_GT(driver.stroke(hip_W, 10).back().force_W.z(), 0.2);
    driver.edit(*after);
    TickOutput out = driver.at(hip_W);
    for (int i = 0; isPaper() && i < 2; ++i) out = driver.at(hip_W);
    if (after == &nothing) {
      EXPECT_TRUE(out.force_W.isZero(0));
      EXPECT_FALSE(out.in_contact);
    } else {
      EXPECT_NEAR(out.force_W.z(), trueForce(make(), lower, hip_W), kSamePlane_N);
    }
  }
}

TEST_P(EditsFelt, ThePlaneIsRenewedWithTheWindowWhateverN) {
  if (isPaper()) return;
  const AnalyticVolume before = layer(20e-3);
  const AnalyticVolume after =
      millimetreVolume([](const Vec3& p_W) { return 20.5e-3 + 0.3 * (p_W.x() - kAt.x()) - p_W.z(); }, kSide);
  const Vec3 hip_W = height(19e-3);
  const auto algorithm = make(1000);
  AlgorithmDriver driver(*algorithm, before, height(22e-3), kSide);
  driver.follow = false;
  driver.at(height(22e-3));
  driver.stroke(hip_W, 30);
  driver.edit(after);
  const TickOutput out = driver.at(hip_W);
  ASSERT_TRUE(out.in_contact);
  EXPECT_EQ(out.plane_age_ticks, 0);
  EXPECT_LT((out.normal_W - Vec3(-0.3, 0, 1).normalized()).norm(), 1e-3);
}

// Balls are added and removed around a tool that goes about and rests a few ticks before each edit. In the tick of an
// edit the force gains, along its new direction, a share of the present depth at most, and what one plane differs from
// another of the same surface: on one this rough a search ends up to a voxel aside, 1/8 of a voxel off. Shown at once,
// a ball would throw with 1 N and more.
TEST_P(EditsFelt, AHundredRandomEditsStayFiniteGentleAndInLimit) {
  std::mt19937 engine(7);
  const auto between = [&](double low, double high) {
    return low + (high - low) * (static_cast<double>(engine()) / 4294967296.0);
  };
  const auto somewhere = [&](double reach_m) {
    return Vec3(kAt + Vec3(between(-reach_m, reach_m), between(-reach_m, reach_m), between(-reach_m, reach_m)));
  };
  std::vector<double> samples(std::size_t{kSide} * kSide * kSide);
  const auto index = [](const Vec3& p_W) {
    const Vec3i at = (p_W / kVoxel).array().round().cast<int>().matrix();
    return at.x() + kSide * (at.y() + kSide * static_cast<std::size_t>(at.z()));
  };
  const AnalyticVolume volume = millimetreVolume([&](const Vec3& p_W) { return samples[index(p_W)]; }, kSide);
  const auto forEach = [&](auto change) {
    for (int k = 0; k < kSide; ++k)
      for (int j = 0; j < kSide; ++j)
        for (int i = 0; i < kSide; ++i) {
          const Vec3 p_W = Vec3(i, j, k) * kVoxel;
          change(p_W, samples[index(p_W)]);
        }
  };
  // Ramps of two voxels on either side of the surface, as the brush makes them.
  static constexpr double kRamp = 2e-3;
  forEach([](const Vec3& p_W, double& f) { f = std::clamp(20e-3 - p_W.z(), -kRamp, kRamp); });

  const auto algorithm = make();
  Vec3 hip_W = height(23e-3);
  AlgorithmDriver driver(*algorithm, volume, hip_W, kSide);
  driver.follow = false;
  const double unfelt_N = 1e-6 + (hasVhip() ? kSamePlane_N + kStiffness * kVoxel / 8 : 0);
  int felt = 0;
  for (int edit = 0; edit < 100; ++edit) {
    const Vec3 from_W = hip_W;
    const Vec3 to_W = somewhere(5e-3);
    TickOutput last;
    const auto tick = [&] {
      const TickOutput out = driver.at(hip_W);
      EXPECT_TRUE(out.force_W.allFinite() && out.vhip_W.allFinite() && out.surface_W.allFinite());
      // As deep as a way out may be, and viscosity.
      EXPECT_LE(out.force_W.norm(), kStiffness * 32 * kVoxel + 2 * (to_W - from_W).norm() / 40e-3);
      last = out;
    };
    for (int i = 1; i <= 40; ++i) {
      hip_W = from_W + (to_W - from_W) * (i / 40.0);
      tick();
    }
    for (int i = 0; i < 3; ++i) tick();
    const Vec3 centre_W = hip_W + (somewhere(3e-3) - kAt);
    const double radius_m = between(1e-3, 4e-3);
    const bool add = between(0, 1) < 0.5;
    forEach([&](const Vec3& p_W, double& f) {
      const double depth_m = std::clamp(radius_m - (p_W - centre_W).norm(), -kRamp, kRamp);
      f = add ? std::max(f, depth_m) : std::min(f, -depth_m);
    });
    driver.edit(volume);
    const Vec3 before_W = last.force_W;
    tick();
    if (last.force_W.isZero(0)) continue;
    ++felt;
    if (isPaper()) continue;
    const double gain_N = last.force_W.norm() - std::max(0.0, before_W.dot(last.force_W.normalized()));
    const double deepest_m = hasVhip() ? (last.surface_W - hip_W).norm() : kContrast;
    ASSERT_LE(gain_N, share_N(deepest_m) + unfelt_N) << edit;
  }
  EXPECT_GT(felt, 10);
}

// A ball is taken away around the HIP and the surface over it: the tool is in the air, whatever wall of the hollow is
// nearest and whichever way that faces.
TEST_P(EditsFelt, AHollowAroundTheToolLetsGoAtOnce) {
  if (isPaper()) return;
  Seeded random(21);
  for (int trial = 0; trial < 100; ++trial) {
    SCOPED_TRACE(trial);
    const double depth_m = random.between(0.3e-3, 2e-3), radius_m = random.between(3e-3, 6e-3);
    const double top_m = 20.3e-3;
    const Vec3 hip_W(random.between(19e-3, 21e-3), random.between(19e-3, 21e-3), top_m - depth_m);
    // HIP and surface are both a voxel and a half inside the ball, so that samples and formula agree on them.
    Vec3 centre_W;
    do {
      centre_W = hip_W + Vec3(0, 0, depth_m / 2) + random.direction() * random.between(0, radius_m);
    } while (std::max((centre_W - hip_W).norm(), (centre_W - hip_W - Vec3(0, 0, depth_m)).norm()) > radius_m - 0.4e-3);
    const AnalyticVolume before = layer(top_m);
    const AnalyticVolume after = millimetreVolume(
        [=](const Vec3& p_W) { return std::min(top_m - p_W.z(), (p_W - centre_W).norm() - radius_m); }, kSide);
    const auto algorithm = make(trial % 2 == 0 ? 1 : 1000);
    const Vec3 above_W = hip_W + Vec3(0, 0, depth_m + 1e-3);
    AlgorithmDriver driver(*algorithm, before, above_W, kSide);
    driver.follow = false;
    driver.at(above_W);
    ASSERT_TRUE(driver.at(hip_W).in_contact);
    driver.edit(after);
    const TickOutput out = driver.at(hip_W);
    EXPECT_FALSE(out.in_contact) << out.force_W.transpose();
    EXPECT_TRUE(out.force_W.isZero(0)) << out.force_W.transpose();
    EXPECT_EQ(out.faults, 0u);
    // Nor does the contact come back while the tool rests there.
    for (const TickOutput& later : driver.stroke(hip_W, 5)) ASSERT_FALSE(later.in_contact);
  }
}

// A floor beside the volume holds the tool; an edit that puts material below the floor, and one elsewhere, changes no
// bit of its force; and one that comes through the floor adds gently to it.
TEST_P(EditsFelt, ObjectsBesideTheVolumeAreNotEased) {
  if (!hasVhip()) return;
  const AnalyticVolume low = layer(12e-3);
  const AnalyticVolume below = layer(16e-3);
  const AnalyticVolume through = layer(20e-3);
  AlgorithmSetup setup = setupFor(
      GetParam(), {.stiffness_N_per_m = kStiffness, .damping_Ns_per_m = 0, .plane_renewal_ticks = 1}, low, kContrast);
  setup.objects.push_back(std::make_shared<const PlaneObject>(height(18e-3), Vec3::UnitZ()));
  const auto algorithm = makeAlgorithm(GetParam(), std::move(setup));
  AlgorithmDriver driver(*algorithm, low, height(22e-3), kSide);
  driver.follow = false;
  driver.at(height(22e-3));
  const Vec3 hip_W = height(17e-3);
  driver.stroke(hip_W, 50);
  const Vec3 held_W = driver.stroke(hip_W, 3).back().force_W;
  ASSERT_NEAR(held_W.z(), kStiffness * 1e-3, kStiffness * 3e-6);
  driver.edit(below);
  for (const TickOutput& out : driver.stroke(hip_W, 20)) ASSERT_EQ(out.force_W, held_W);
  driver.edit(through);
  // Away from the floor, along the same normal.
  double last_N = held_W.z();
  for (int i = 0; i < 520; ++i) {
    const double force_N = driver.at(hip_W).force_W.z();
    ASSERT_LE(force_N - last_N, share_N(3e-3) + kSamePlane_N) << i;
    ASSERT_GE(force_N, held_W.z() - kSamePlane_N) << i;
    last_N = force_N;
  }
}

std::vector<std::string> thoseThatFeelEdits() {
  std::vector<std::string> names;
  for (const AlgorithmEntry& entry : algorithms()) {
    if (!entry.needs.isosurface_mesh) names.emplace_back(entry.name);
  }
  return names;
}

INSTANTIATE_TEST_SUITE_P(Each, EditsFelt, testing::ValuesIn(thoseThatFeelEdits()),
                         [](const testing::TestParamInfo<std::string>& name) {
                           std::string word = name.param;
                           std::replace(word.begin(), word.end(), '-', '_');
                           return word;
                         });

// ---- the easing itself ----

TEST(EditEase, DrainsEvenlyInHalfASecondAtAnyRate) {
  for (const double rate_hz : {1000.0, 4000.0, 333.0}) {
    EditEase ease(rate_hz);
    EXPECT_FALSE(ease.active());
    ease.take(1, 3);
    const int ticks = static_cast<int>(std::lround(0.5 * rate_hz));
    for (int i = 1; i <= ticks; ++i) {
      ease.elapse(3);
      ASSERT_NEAR(ease.amount(), 2 * (1 - static_cast<double>(i) / ticks), 1e-12) << i;
    }
    ease.elapse(3);
    EXPECT_FALSE(ease.active());
  }
}

TEST(EditEase, ALaterAdditionNeverSlowsWhatDrains) {
  EditEase ease(1000);
  ease.take(0, 1);
  for (int i = 0; i < 250; ++i) ease.elapse(1);
  EXPECT_NEAR(ease.amount(), 0.5, 1e-12);
  ease.take(0.5, 1.1);  // 0.1 more
  EXPECT_NEAR(ease.amount(), 0.6, 1e-12);
  for (int i = 0; i < 301; ++i) ease.elapse(1.1);
  EXPECT_FALSE(ease.active());
}

TEST(EditEase, NeverMoreThanTheWholeAndNothingForWhatIsTakenAway) {
  EditEase ease(1000);
  ease.take(0, 1);
  ease.elapse(0.25);
  EXPECT_EQ(ease.amount(), 0.25);
  ease.take(0, 0.1);  // 0.15 less
  EXPECT_NEAR(ease.amount(), 0.1, 1e-12);
  ease.take(0, 0);
  EXPECT_FALSE(ease.active());
  ease.take(1, 0.5);
  EXPECT_FALSE(ease.active());
  ease.take(1, 1.01, 0.02);
  EXPECT_FALSE(ease.active());
  ease.take(0, 1);
  ease.elapse(0);
  EXPECT_FALSE(ease.active());
}

}  // namespace edits_felt_test
}  // namespace palpate
