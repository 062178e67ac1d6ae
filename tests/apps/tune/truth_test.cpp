// SPDX-License-Identifier: Apache-2.0
// Truth: a sphere, whose nearest surface point is its centre plus the radius along the ray.
#include "apps/tune/truth.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace palpate {
namespace truth_test {

constexpr const char* kSphere = "phantom:sphere?size=32";

TickRecord touching(double time_s, const Vec3& hip_W, double depth_m) {
  TickRecord record;
  record.time_s = time_s;
  record.in_contact = true;
  const Vec3 normal_W = hip_W.normalized();
  for (int axis = 0; axis < 3; ++axis) {
    record.hip_W[axis] = hip_W[axis];
    record.normal_W[axis] = normal_W[axis];
    record.force_W[axis] = normal_W[axis];
  }
  record.depth_m = depth_m;
  return record;
}

double radius_m() {
  return -makePhantom(kSphere)->signedDistance_m(Vec3::Zero());
}

// Each tick finds the surface k tenths of a millimetre outside the true one; with 1000 N/m that is k tenths of a
// newton.
TEST(Truth, OfAPhantomIsItsExactSurface) {
  std::vector<TickRecord> records;
  for (int k = 1; k <= 100; ++k) {
    const Vec3 hip_W = Vec3(1, 0.1 * k, 0.3).normalized() * (radius_m() - 1e-3);
    records.push_back(touching(1e-3 * k, hip_W, 1e-3 + 1e-4 * k));
  }
  const auto truth = exactTruth(kSphere);
  const RunErrors errors = runErrors(*truth, records, {}, 1000);
  EXPECT_NEAR(errors.p99_N, 9.9, 1e-9);
  EXPECT_EQ(errors.contact_share, 1);
}

// Two thirds of the slide's ticks are in contact; the last should be, and errs by 1 mm as the others do.
TEST(Truth, CountsTheSlideAndItsContact) {
  const Vec3 hip_W = Vec3::UnitX() * (radius_m() - 1e-3);
  std::vector<TickRecord> records = {touching(0.1, hip_W, 5e-3), touching(1.1, hip_W, 2e-3), touching(1.2, hip_W, 2e-3),
                                     touching(1.3, hip_W, 2e-3)};
  records[3].in_contact = false;
  records[3].depth_m = 0;
  const auto truth = exactTruth(kSphere);
  const RunErrors errors = runErrors(*truth, records, {{"press", 0, 1}, {"slide", 1, 2}}, 1000);
  EXPECT_NEAR(errors.p99_N, 1, 1e-9);
  EXPECT_NEAR(errors.contact_share, 2.0 / 3, 1e-12);
}

// A tick without the contact that should be: K times the true depth, 1 mm. Three of a hundred are more than the
// percentile leaves out.
TEST(Truth, ATickThatLosesTheContactErrsByTheWholeForce) {
  const Vec3 hip_W = Vec3::UnitX() * (radius_m() - 1e-3);
  std::vector<TickRecord> records(100, touching(1, hip_W, 1e-3));
  for (std::size_t i = 40; i < 43; ++i) records[i].in_contact = false;
  for (std::size_t i = 40; i < 43; ++i) records[i].depth_m = 0;
  const auto exact = exactTruth(kSphere);
  EXPECT_NEAR(runErrors(*exact, records, {}, 1000).p99_N, 1, 1e-9);
  EXPECT_NEAR(runErrors(*exact, records, {}, 1000).contact_share, 0.97, 1e-12);
  const auto felt = feltTruth([&](const auto& along) { return std::vector(along.size(), touching(1, hip_W, 1e-3)); });
  EXPECT_NEAR(runErrors(*felt, records, {}, 1000).p99_N, 1, 1e-9);
}

// A contact that should not be: K times the depth that was found.
TEST(Truth, ATickWithAContactTooManyErrsByTheWholeForce) {
  const Vec3 hip_W = Vec3::UnitX() * (radius_m() + 0.1e-3);
  const std::vector<TickRecord> records(100, touching(1, hip_W, 0.3e-3));
  const auto exact = exactTruth(kSphere);
  EXPECT_NEAR(runErrors(*exact, records, {}, 1000).p99_N, 0.3, 1e-9);
  const auto felt = feltTruth([](const auto& along) { return std::vector<TickRecord>(along.size()); });
  EXPECT_NEAR(runErrors(*felt, records, {}, 1000).p99_N, 0.3, 1e-9);
}

TEST(Truth, OfAnythingElseIsWhatIsFeltAtTheSamePlaces) {
  const Vec3 hip_W = Vec3::UnitX() * 9e-3;
  const std::vector<TickRecord> records = {touching(0, hip_W, 1.2e-3), touching(1, hip_W, 1e-3)};
  int runs = 0;
  const auto truth = feltTruth([&](const std::vector<TickRecord>& along) {
    ++runs;
    std::vector<TickRecord> felt = along;
    for (TickRecord& record : felt) record.depth_m = 1e-3;
    return felt;
  });
  EXPECT_NEAR(runErrors(*truth, records, {}, 1000).p99_N, 0.2, 1e-12);
  EXPECT_NEAR(runErrors(*truth, records, {}, 500).p99_N, 0.1, 1e-12);
  EXPECT_EQ(runs, 1);  // the places are the same
  EXPECT_NEAR(runErrors(*truth, {touching(0, 2 * hip_W, 1e-3)}, {}, 500).p99_N, 0, 1e-12);
  EXPECT_EQ(runs, 2);
}

TEST(Truth, IsNotKnownWithoutContact) {
  const auto truth = exactTruth(kSphere);
  TickRecord free = touching(0, Vec3::UnitX() * (radius_m() + 1e-3), 0);
  free.in_contact = false;
  EXPECT_TRUE(std::isnan(runErrors(*truth, {free}, {}, 1000).p99_N));
  EXPECT_TRUE(std::isnan(runErrors(*truth, {}, {}, 1000).p99_N));
}

TEST(Truth, IsExactOnlyForAPhantomAlone) {
  Scene scene;
  scene.volume = kSphere;
  EXPECT_EQ(whyNotExact(scene, 0), "");
  EXPECT_NE(whyNotExact(scene, 10), "");
  scene.objects.emplace_back();
  EXPECT_EQ(whyNotExact(scene, 0), "the scene has objects");
  scene.objects.clear();
  scene.edit = "remove:radius=2mm";
  EXPECT_EQ(whyNotExact(scene, 0), "the tool edits");
  scene.edit.clear();
  scene.volume = "phantom:random?size=8";
  EXPECT_NE(whyNotExact(scene, 0), "");
  scene.volume = "scan.nii";
  EXPECT_EQ(whyNotExact(scene, 0), "the volume is no phantom");
}

}  // namespace truth_test
}  // namespace palpate
