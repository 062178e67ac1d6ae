// SPDX-License-Identifier: Apache-2.0
#include "apps/view/contact_region.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace palpate {
namespace contact_region_test {

TickRecord contactAt(double x_m) {
  TickRecord r;
  r.vhip_W[0] = x_m;
  r.hip_W[2] = -1e-3;
  r.normal_W[2] = 1;
  r.in_contact = true;
  return r;
}

TEST(ContactRegion, SurroundsTheContactOnly) {
  TickRecord far;
  far.hip_W[0] = 1;
  const ContactRegion region = findContactRegion({far, contactAt(0.01), contactAt(0.02), contactAt(0.03), far}, 1e-3);
  EXPECT_TRUE(region.touched);
  EXPECT_LT((region.centre_W - Vec3(0.02, 0, 0)).norm(), 1e-12);
  EXPECT_DOUBLE_EQ(region.radius_m, 0.0125);  // a quarter more than to the farthest
  EXPECT_EQ(region.points_W.size(), 3U);
  EXPECT_LT((region.normal_W - Vec3::UnitZ()).norm(), 1e-12);
  EXPECT_LT((region.along_W - Vec3::UnitX()).norm(), 1e-12);
}

// 100 contacts whose normals are y and z in turn, along (2, 0, 1): of more than 40, every third is kept.
TEST(ContactRegion, HasTheMeanNormalAndSomeOfThePoints) {
  std::vector<TickRecord> records(100);
  for (std::size_t i = 0; i < records.size(); ++i) {
    records[i].in_contact = true;
    records[i].vhip_W[0] = 2e-3 * static_cast<double>(i);
    records[i].vhip_W[2] = 1e-3 * static_cast<double>(i);
    records[i].normal_W[1 + i % 2] = 1;
  }
  const ContactRegion region = findContactRegion(records, 1e-3);
  EXPECT_LT((region.normal_W - Vec3(0, 1, 1).normalized()).norm(), 1e-12);
  EXPECT_LT((region.along_W - Vec3(2, -0.5, 0.5).normalized()).norm(), 1e-12);
  EXPECT_LT((region.centre_W - Vec3(99e-3, 0, 49.5e-3)).norm(), 1e-12);
  EXPECT_NEAR(region.radius_m, 1.25 * std::hypot(99e-3, 49.5e-3), 1e-12);
  ASSERT_EQ(region.points_W.size(), 34U);
  EXPECT_LT((region.points_W[1] - Vec3(6e-3, 0, 3e-3)).norm(), 1e-12);
}

TEST(ContactRegion, OfATapHasSurroundings) {
  const ContactRegion region = findContactRegion({contactAt(0), contactAt(0)}, 4e-3);
  EXPECT_EQ(region.radius_m, 4e-3);
  EXPECT_NEAR(region.along_W.dot(region.normal_W), 0, 1e-12);
}

TEST(ContactRegion, WithoutContactIsThatOfThePath) {
  TickRecord a, b;
  b.hip_W[1] = 0.02;
  const ContactRegion region = findContactRegion({a, b}, 1e-3);
  EXPECT_FALSE(region.touched);
  EXPECT_LT((region.centre_W - Vec3(0, 0.01, 0)).norm(), 1e-12);
}

TEST(ContactRegion, OfNothingIsThere) {
  EXPECT_EQ(findContactRegion({}, 2e-3).radius_m, 2e-3);
}

}  // namespace contact_region_test
}  // namespace palpate
