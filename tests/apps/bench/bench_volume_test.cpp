// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/bench_volume.hpp"

#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "apps/sampled/window_follower.hpp"
#include "base/error.hpp"
#include "engine/reference/window.hpp"

namespace palpate {
namespace bench_volume_test {

// The window must be the one that the twin of the engine's kernel gathers, sample by sample.
TEST(BenchVolume, GathersWhatTheEngineWould) {
  const std::string name = "phantom:knot?size=40x36x34&spacing=0.8x1x1.2mm";
  const BenchVolume volume(name);
  const WindowBox box{{5, 4, 0}, {32, 32, 32}};
  std::vector<Sample> samples;
  SampleWindow window;
  volume.gather(box, samples, window);
  const auto expected =
      reference::windowSamples(reference::denseField(makeVolume(*makePhantom(name))), box.first, box.size);
  ASSERT_EQ(samples.size(), expected.size());
  EXPECT_EQ(std::memcmp(samples.data(), expected.data(), samples.size() * sizeof(Sample)), 0);
  EXPECT_TRUE(window.usable());
  EXPECT_EQ(window.version, 1U);
  EXPECT_EQ(window.low_is_border, (std::array<bool, 3>{false, false, true}));
  EXPECT_EQ(window.high_is_border, (std::array<bool, 3>{false, true, false}));
  const Vec3 first_W = volume.phantom().lattice().toWorld(Vec3(5, 4, 0));
  EXPECT_LT((window.lattice.origin_W - first_W).norm(), 1e-15);
}

// A box of 32 voxels begins at a whole voxel, so the tool is up to half a voxel off its middle: the first change comes
// after six voxels of way less that, every further one after exactly six.
TEST(WindowRule, FollowsTheToolInStepsOfSixVoxels) {
  const BenchVolume volume("phantom:sphere?size=128x128x64");
  const auto at = [&](double i) { return volume.phantom().lattice().toWorld(Vec3(i, 64, 32)); };
  WindowRule rule;
  ASSERT_TRUE(rule.follow(volume, at(64)));
  std::vector<double> changes;
  for (double i = 64; i < 100; i += 0.25) {
    if (rule.follow(volume, at(i))) changes.push_back(i);
  }
  ASSERT_GE(changes.size(), 5U);
  EXPECT_NEAR(changes[0], 70, 0.5);
  for (std::size_t n = 1; n < changes.size(); ++n) EXPECT_DOUBLE_EQ(changes[n] - changes[n - 1], 6);
}

// Where the volume's border stops the box, it goes there at once, though the way is shorter than six voxels; and rests.
TEST(WindowRule, GoesToTheBorderAtOnce) {
  const BenchVolume volume("phantom:sphere?size=128x128x64");
  for (int axis = 0; axis < 3; ++axis) {
    const int last = volume.size()[axis] - 32;
    for (const bool high : {true, false}) {
      // With the tool 16 voxels behind a box's first one, `first` is where the box begins, cut to the volume.
      const auto first = [&](WindowRule& rule, int wanted) -> std::optional<int> {
        Vec3 place_L = (volume.size() / 2).cast<double>();
        place_L[axis] = wanted + 16;
        const auto box = rule.follow(volume, volume.phantom().lattice().toWorld(place_L));
        return box ? std::optional(box->first[axis]) : std::nullopt;
      };
      WindowRule rule;
      EXPECT_EQ(first(rule, high ? last - 4 : 4), high ? last - 4 : 4);
      EXPECT_EQ(first(rule, high ? last - 1 : 1), std::nullopt);
      EXPECT_EQ(first(rule, high ? last : 0), high ? last : 0);
      EXPECT_EQ(first(rule, high ? last + 9 : -9), std::nullopt);  // it is there already
    }
  }
}

TEST(BenchVolume, AsOneWindowHasEverySample) {
  const BenchVolume volume("phantom:knot?size=40x36x34");
  const SampleWindow whole = volume.whole();
  EXPECT_TRUE(whole.usable());
  EXPECT_EQ(whole.size, Vec3i(40, 36, 34));
  EXPECT_EQ(whole.low_is_border, (std::array<bool, 3>{true, true, true}));
  EXPECT_EQ(whole.high_is_border, (std::array<bool, 3>{true, true, true}));
  EXPECT_EQ(whole.lattice.origin_W, volume.phantom().lattice().origin_W);
  const Volume made = makeVolume(volume.phantom());
  EXPECT_EQ(whole.samples[(7 * 36 + 5) * 40 + 3].density, made.value({3, 5, 7}));
  EXPECT_EQ(volume.maximum(), made.maximum());
}

TEST(WindowFollower, HoldsTheToolWithRoomAround) {
  const BenchVolume volume("phantom:sphere?size=128x128x64");
  WindowFollower follower(volume);
  for (double i = 20; i < 108; i += 0.5) {
    const Vec3 tool_W = volume.phantom().lattice().toWorld(Vec3(i, 128 - i, 32));
    const SampleWindow& window = follower.around(tool_W);
    const Vec3 p_L = window.lattice.toIndex(tool_W);
    EXPECT_GE(p_L.minCoeff(), 9);  // 16 in the middle, less than six of way, rounding of the box by one
    EXPECT_LE(p_L.maxCoeff(), 32 - 9);
  }
}

// The noise in the samples has the deviation that moves a surface by as much: slope times that part of a voxel. Over
// 262144 samples the deviation is known to 1 / sqrt(2 * 262144), 0.14 %; five of that.
TEST(BenchVolume, NoiseIsToldAsHowFarItMovesTheSurface) {
  for (const char* name : {"phantom:sphere?size=64", "phantom:knot?size=64x64x64&spacing=0.5x0.5x3mm"}) {
    EXPECT_EQ(withNoise(name, 0, 3), name);
    const BenchVolume exact(name);
    const double slope = exact.phantom().profile().slope_per_m;
    for (const double noise_voxel : {0.1, 0.5}) {
      const BenchVolume noisy(withNoise(name, noise_voxel, 3));
      double sum = 0;
      const SampleWindow a = exact.whole();
      const SampleWindow b = noisy.whole();
      for (std::ptrdiff_t i = 0; i < a.size.prod(); ++i) {
        const double difference = static_cast<double>(b.samples[i].density) - static_cast<double>(a.samples[i].density);
        sum += difference * difference;
      }
      const double deviation = std::sqrt(sum / a.size.prod());
      EXPECT_NEAR(deviation / (noise_voxel * exact.voxel_m() * slope), 1, 0.007) << name << " " << noise_voxel;
      const Vec3 p_W(3e-3, 4e-3, 5e-3);
      EXPECT_EQ(noisy.phantom().signedDistance_m(p_W), exact.phantom().signedDistance_m(p_W));
    }
  }
}

TEST(BenchVolume, BorderDistanceIsTheNearestFacesAndNegativeBeyond) {
  const BenchVolume volume("phantom:sphere?size=64");
  const Lattice& lattice = volume.phantom().lattice();
  EXPECT_NEAR(volume.borderDistance(lattice.toWorld(Vec3(3, 20, 30))), 3, 1e-9);
  EXPECT_NEAR(volume.borderDistance(lattice.toWorld(Vec3(20, 20, 61))), 2, 1e-9);
  EXPECT_NEAR(volume.borderDistance(lattice.toWorld(Vec3(-1, 20, 30))), -1, 1e-9);
}

TEST(BenchVolume, RefusesWhatIsNoPhantom) {
  EXPECT_THROW(BenchVolume("phantom:cube"), Error);
}

}  // namespace bench_volume_test
}  // namespace palpate
