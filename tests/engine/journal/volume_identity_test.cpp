// SPDX-License-Identifier: Apache-2.0
#include "engine/journal/volume_identity.hpp"

#include <filesystem>
#include <set>

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
  const auto differenceWith = [&](const auto& change) {
    VolumeIdentity other = identityOf(volume);
    change(other);
    return differenceFrom(other, volume);
  };
  EXPECT_EQ(differenceWith([](VolumeIdentity& other) {
              other.size = {28, 22, 20};
            }),
            "it has 27 x 22 x 19 voxels instead of 28 x 22 x 20");
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(differenceWith([&](VolumeIdentity& other) { other.lattice.spacing_m[axis] *= 2; }),
              "its voxels have another size");
    EXPECT_EQ(differenceWith([&](VolumeIdentity& other) { other.lattice.origin_W[axis] += 1; }),
              "it lies elsewhere in the world");
    EXPECT_EQ(differenceWith([&](VolumeIdentity& other) { other.lattice.R_WL.col(axis) *= -1; }),
              "it lies elsewhere in the world");
  }
  EXPECT_EQ(differenceWith([](VolumeIdentity& other) { other.content += 1; }), "its densities are others");
}

// Journals on disk hold the hash, so it must not change: worked out apart from this program, by its definition. One
// brick of 1; then a brick of 2 and one of 0 to 511, and behind them how many bricks there are.
TEST(VolumeIdentity, IsTheSameForEver) {
  EXPECT_EQ(contentHash(Volume::fromDense({8, 8, 8}, {}, std::vector<float>(512, 1.0F), {})), 0x5db84d53cc34499aU);
  const Volume two = Volume::fromBricks({16, 8, 8}, {}, {}, [](const Vec3i& brick, float* values) {
    values[0] = 2;
    for (int n = 0; n < kBrickVoxels && brick.x() == 1; ++n) values[n] = static_cast<float>(n);
    return brick.x() == 0;
  });
  EXPECT_EQ(contentHash(two), 0x3376a75e500fd379U);
}

// Every byte counts, in whole pieces of eight bytes and in the rest, and so does the length: zeros at the end too.
TEST(BytesHash, ChangesWithEveryByteAndTheLength) {
  const std::string bytes = "nineteen bytes long";
  ASSERT_EQ(bytes.size(), 19U);
  EXPECT_EQ(bytesHash(bytes), bytesHash(std::string(bytes)));
  std::set<std::uint64_t> hashes = {bytesHash(bytes)};
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    std::string changed = bytes;
    changed[at] = static_cast<char>(changed[at] ^ 1);
    hashes.insert(bytesHash(changed));
  }
  EXPECT_EQ(hashes.size(), 20U);
  hashes.clear();
  for (std::size_t length = 0; length <= 24; ++length) hashes.insert(bytesHash(std::string(length, '\0')));
  EXPECT_EQ(hashes.size(), 25U);
}

TEST(VolumeIdentity, NamesFilesByTheirAbsolutePath) {
  const auto of = [](const char* source) {
    VolumeFacts facts;
    facts.source = source;
    return identityOf(Volume::fromDense({3, 2, 1}, sampleLattice(), {1, 2, 3, 4, 5, 6}, facts));
  };
  EXPECT_EQ(of("phantom:knot").source, "phantom:knot");
  EXPECT_EQ(of("").source, "");
  EXPECT_EQ(of("/a/b.vdb#one").source, "/a/b.vdb#one");
  EXPECT_EQ(of("b.vdb#one").source, (std::filesystem::current_path() / "b.vdb#one").string());
  EXPECT_EQ(of("").size, Vec3i(3, 2, 1));
  EXPECT_EQ(of("").lattice.origin_W, sampleLattice().origin_W);
}

}  // namespace volume_identity_test
}  // namespace palpate
