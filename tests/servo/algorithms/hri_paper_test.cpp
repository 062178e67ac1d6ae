// SPDX-License-Identifier: Apache-2.0
#include "servo/algorithms/hri_paper.hpp"

#include <gtest/gtest.h>

#include "servo/safety/faults.hpp"
#include "support/analytic_volume.hpp"

namespace palpate {
namespace hri_paper_test {

// Density 10 mm - z above z = 0: background above 10 mm, gradient (0, 0, -1), so p is exact wherever the ray crosses.
// A kink makes the plane's age visible: for x > 10 mm the surface is 1 mm lower (the step lies between two samples).
class HriPaperTable : public testing::Test {
 protected:
  HriPaperTable() {
    volume = millimetreVolume([](const Vec3& p_W) { return (p_W.x() < 10.5e-3 ? 10e-3 : 9e-3) - p_W.z(); }, 32);
    volume.hold(held, Vec3i::Zero(), Vec3i::Constant(32));
  }
  TickOutput at(HriPaper& hri, double x_mm, double z_mm, double vz = 0) {
    TickOutput out;
    hri.tick({Vec3(x_mm * 1e-3, 5e-3, z_mm * 1e-3), Vec3(0, 0, vz), &held.window}, out);
    return out;
  }
  static AlgorithmParameters parameters(int n) { return {0.0, 500, 0.5, n}; }
  AnalyticVolume volume;
  HeldWindow held;
};

// Figure 2 worked by hand for n = 2, K = 500 N/m, B = 0. The tool stays at z = 9 mm (x = 5 mm: surface at 10 mm, depth
// 1 mm) and goes over to x = 20 mm (surface at 9 mm) in tick 3; depth there is 0.5 mm at z = 8.5 mm. tick  c before
// branch                       c after  plane         depth, force
//  0      0       no plane, HIP outside          0      none          0
//  1      0       no plane, made                 0      z = 10        1 mm,   0.5 N
//  2      0       c < n: c + 1                   1      z = 10        1 mm,   0.5 N
//  3      1       c < n: c + 1                   2      z = 10        1.5 mm, 0.75 N   (moved to x = 20, z = 8.5: old
//  plane) 4      2       c >= n: c = 0, renewed         0      line's p      renewed after n + 1 = 3 ticks 5      0 c <
//  n                          1      same 6      1       c < n                          2      same 7      2       c >=
//  n: c = 0, HIP inside      0      renewed 8..10          HIP outside at z = 12 from 8: plane stays for c = 1, 2, but
//  N.(HIP - p) >= 0, F = 0; dropped in tick 10
// 11      0       no plane, HIP inside again: made at once; c stays 0
TEST_F(HriPaperTable, CounterAndForcesAsPrinted) {
  HriPaper hri(AlgorithmParameters{0.0, 500, 0.0, 2});
  hri.reset(Vec3(5e-3, 5e-3, 11e-3));
  struct Row {
    double x_mm, z_mm;
    bool contact;
    int age;
  };
  const Row rows[] = {{5, 11, false, 0},  {5, 9, true, 0},    {5, 9, true, 1},    {20, 8.5, true, 2},
                      {20, 8.5, true, 0}, {20, 8.5, true, 1}, {20, 8.5, true, 2}, {20, 8.5, true, 0},
                      {20, 12, false, 1}, {20, 12, false, 2}, {20, 12, false, 0}, {20, 8.5, true, 0}};
  std::vector<TickOutput> outs;
  for (const Row& row : rows) {
    outs.push_back(at(hri, row.x_mm, row.z_mm));
    EXPECT_EQ(outs.back().in_contact, row.contact) << "tick " << outs.size() - 1;
    EXPECT_EQ(outs.back().plane_age_ticks, row.age) << "tick " << outs.size() - 1;
    EXPECT_EQ(outs.back().faults, 0u);
  }
  // Densities are floats of 1e-3: forces are good to 500 N/m * 1e-2 m * 6e-8, some 1e-6 N.
  EXPECT_NEAR(outs[1].force_W.z(), 0.5, 1e-5);
  EXPECT_NEAR(outs[2].force_W.z(), 0.5, 1e-5);
  EXPECT_NEAR(outs[3].force_W.z(), 0.75, 1e-5);
  EXPECT_NEAR(outs[3].vhip_W.z(), 10e-3, 1e-8);
  // Tick 4: VHIP (20, 5, 10) mm has density -1 mm, HIP 0.5 mm: p at 9 mm.
  EXPECT_NEAR(outs[4].force_W.z(), 0.25, 1e-5);
  EXPECT_NEAR(outs[7].force_W.z(), 0.25, 1e-5);
  EXPECT_TRUE(outs[8].force_W.isZero(0));
  EXPECT_NEAR(outs[11].force_W.z(), 0.25, 1e-5);
}

// The counter is not reset when contact makes a plane: left at 1 by one contact, it shortens the next plane's life.
TEST_F(HriPaperTable, ContactDoesNotResetTheCounter) {
  HriPaper hri(parameters(2));
  hri.reset(Vec3(5e-3, 5e-3, 11e-3));
  at(hri, 5, 9);                                // made, c = 0
  at(hri, 5, 9);                                // c = 1
  at(hri, 5, 11);                               // c = 2, in front
  at(hri, 5, 11);                               // c = 0, dropped
  EXPECT_EQ(at(hri, 5, 9).plane_age_ticks, 0);  // made, c = 0
  EXPECT_EQ(at(hri, 5, 9).plane_age_ticks, 1);  // c = 1
  EXPECT_EQ(at(hri, 5, 9).plane_age_ticks, 2);  // c = 2
  EXPECT_EQ(at(hri, 5, 9).plane_age_ticks, 0);  // c = 0, renewed: n + 1 = 3 ticks after it was made
}

TEST_F(HriPaperTable, DampsAlongTheNormalAndMayPull) {
  HriPaper hri(parameters(1));
  hri.reset(Vec3(5e-3, 5e-3, 11e-3));
  EXPECT_NEAR(at(hri, 5, 9, -1.0).force_W.z(), 0.5 + 0.5, 1e-5);
  EXPECT_NEAR(at(hri, 5, 9, +2.0).force_W.z(), 0.5 - 1.0, 1e-5);
}

TEST_F(HriPaperTable, BothInsideGivesNoForce) {
  HriPaper hri(parameters(1));
  hri.reset(Vec3(5e-3, 5e-3, 8e-3));
  EXPECT_TRUE(at(hri, 5, 7).force_W.isZero(0));
  EXPECT_TRUE(at(hri, 5, 6).force_W.isZero(0));
}

TEST_F(HriPaperTable, BeyondTheWindowIsAFault) {
  volume.size = Vec3i::Constant(64);
  volume.hold(held, Vec3i::Constant(8), Vec3i::Constant(16));
  HriPaper hri(parameters(1));
  hri.reset(Vec3::Zero());
  const TickOutput out = at(hri, 5, 9);
  EXPECT_EQ(out.faults, bit(ServoFault::kBeyondWindow));
  EXPECT_TRUE(out.force_W.isZero(0));
}

TEST_F(HriPaperTable, AFlatFieldIsNoPlane) {
  for (Sample& s : held.samples) s.gradient_i = s.gradient_j = s.gradient_k = 0;
  HriPaper hri(parameters(1));
  hri.reset(Vec3(5e-3, 5e-3, 11e-3));
  const TickOutput out = at(hri, 5, 9);
  EXPECT_EQ(out.faults, bit(ServoFault::kZeroGradient));
  EXPECT_TRUE(out.force_W.isZero(0));
}

TEST_F(HriPaperTable, NoWindow) {
  HriPaper hri(parameters(1));
  held.window.version = 0;
  EXPECT_EQ(at(hri, 5, 9).faults, bit(ServoFault::kNoWindow));
}

}  // namespace hri_paper_test
}  // namespace palpate
