// SPDX-License-Identifier: Apache-2.0
#include "engine/journal/volume_identity.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "journal_samples.hpp"

namespace palpate {
namespace volume_identity_test {

using ::testing::HasSubstr;

TEST(VolumeIdentity, IsTheSameForEqualVolumes) {
  EXPECT_EQ(contentHash(sampleVolume()), contentHash(sampleVolume()));
  EXPECT_EQ(differenceFrom(identityOf(sampleVolume()), sampleVolume()), "");
}

TEST(VolumeIdentity, ChangesWithTheLastBitOfAnyVoxel) {
  const Volume before = sampleVolume();
  const std::vector<float> dense = before.toDense();
  // The last two are the domain's last voxel, and the last of a brick that holds many values.
  const std::size_t last_of_brick = 15 + 27 * (15 + 22 * 15);
  for (const std::size_t at : {std::size_t{0}, dense.size() / 2, dense.size() - 1, last_of_brick}) {
    std::vector<float> values = dense;
    values[at] = std::nextafter(values[at], 1000.0F);
    const Volume after = Volume::fromDense(before.size(), before.lattice(), values, {});
    EXPECT_NE(contentHash(after), contentHash(before)) << at;
    EXPECT_THAT(differenceFrom(identityOf(before), after), HasSubstr("densities"));
  }
}

// How a brick is stored is no part of the volume.
TEST(VolumeIdentity, DoesNotSeeStorage) {
  Volume stored = sampleVolume();
  Volume constant = sampleVolume();
  const std::vector<float> values(kBrickVoxels, -100.0F);
  stored.setBrick({0, 0, 0}, values.data());
  constant.setConstantBrick({0, 0, 0}, -100.0F);
  EXPECT_EQ(contentHash(stored), contentHash(constant));
}

TEST(VolumeIdentity, SaysWhatDiffers) {
  const Volume volume = sampleVolume();
  VolumeIdentity other = identityOf(volume);
  other.size.x() += 1;
  EXPECT_THAT(differenceFrom(other, volume), HasSubstr("27 x 22 x 19 voxels instead of 28"));
  other = identityOf(volume);
  other.lattice.spacing_m.x() *= 2;
  EXPECT_THAT(differenceFrom(other, volume), HasSubstr("another size"));
  other = identityOf(volume);
  other.lattice.origin_W.x() += 1;
  EXPECT_THAT(differenceFrom(other, volume), HasSubstr("elsewhere"));
}

}  // namespace volume_identity_test
}  // namespace palpate
