// SPDX-License-Identifier: Apache-2.0
// Truth: the CPU twin, which the kernels equal bit for bit.
#include "apps/bench/resident_gradient.hpp"

#include <random>

#include <gtest/gtest.h>

#include "engine/bricks/active_bricks.hpp"
#include "engine/phantoms/phantom.hpp"
#include "engine/reference/gradient.hpp"
#include "engine/reference/half.hpp"

namespace palpate {
namespace resident_gradient_test {

TEST(ResidentGradient, ItsSamplesAreThoseOfTheTwin) {
  const Volume volume = makeVolume(*makePhantom("phantom:knot?size=37x30x21&noise=0.1"));  // no multiple of a brick
  gpu::Gpu gpu({});
  gpu::Transfer transfer(gpu);
  const BrickPool pool(gpu, transfer, volume);
  const reference::DenseField field = reference::denseField(volume);
  std::mt19937 bits(1);
  std::vector<Vec3i> voxels;
  for (int i = 0; i < 2000; ++i) {
    voxels.emplace_back(static_cast<int>(bits() % 37), static_cast<int>(bits() % 30), static_cast<int>(bits() % 21));
  }
  for (const char* name : {"central", "sobel", "gaussian:1"}) {
    const GradientOperator gradient_operator = gradientOperator(name);
    const reference::DenseField smoothed = reference::smoothedFor(gradient_operator, field);
    for (const SampleFormat& format : {SampleFormat{}, halvesFor(volume)}) {
      ResidentGradient gradient(gpu, transfer, pool, gradient_operator, allBricks(pool.grid()), format);
      EXPECT_GT(gradient.run().wall_ms, 0);
      EXPECT_GT(gradient.movedBytes(), 0);
      const std::vector<Sample> samples = gradient.at(voxels);
      ASSERT_EQ(samples.size(), voxels.size());
      for (std::size_t i = 0; i < voxels.size(); ++i) {
        const Vec3i& v = voxels[i];
        const auto wanted = reference::gradientAt(smoothed, gradient_operator, v.x(), v.y(), v.z());
        Sample twin{wanted[0], wanted[1], wanted[2], field.at(v.x(), v.y(), v.z())};
        if (format.half) twin = reference::stored(twin, format);
        EXPECT_EQ(samples[i].gradient_i, twin.gradient_i) << name << " " << v.transpose();
        EXPECT_EQ(samples[i].gradient_j, twin.gradient_j);
        EXPECT_EQ(samples[i].gradient_k, twin.gradient_k);
        EXPECT_EQ(samples[i].density, twin.density);
      }
    }
  }
}

}  // namespace resident_gradient_test
}  // namespace palpate
