// SPDX-License-Identifier: Apache-2.0
// Gradients of whole fields that take several submissions: nothing is left out or computed twice, whatever the tuning,
// and what is told in between may stop them.
#include <gmock/gmock.h>

#include "base/error.hpp"
#include "engine/bricks/active_bricks.hpp"
#include "engine/passes/gradient_pass.hpp"
#include "servo/window/sample_window.hpp"
#include "test_fields.hpp"
#include "tunings_by_name.hpp"

namespace palpate {
namespace submission_parts_test {

class InParts : public testing::TestWithParam<Tuning> {};

// 21 x 21 x 20 bricks: more than a submission of the row for CPUs. A linear field has one gradient.
TEST_P(InParts, GradientsAreAllThere) {
  const Volume volume =
      makeField({168, 168, 160}, [](int i, int j, int k) { return static_cast<float>(3 * i - 5 * j + 7 * k); });
  gpu::Gpu gpu{{.tuned_as = deviceOf(GetParam())}};
  gpu::Transfer transfer(gpu);
  const BrickPool pool(gpu, transfer, volume);
  for (const char* way : {"central", "sobel"}) {
    const SampleStore store(gpu, pool.brickCount(), allBricks(pool.grid()), makeGpuBudget());
    GradientPass pass(gpu, transfer, pool, store, gradientOperator(way));
    std::vector<double> told;
    pass.run([&](double done) { told.push_back(done); });
    const std::size_t least = (pool.brickCount() - 1) / GetParam().gradient_bricks + 1;
    ASSERT_GE(told.size(), least) << way;
    EXPECT_TRUE(std::is_sorted(told.begin(), told.end())) << way;
    EXPECT_EQ(told.back(), 1) << way;
    std::vector<Sample> samples;
    std::size_t wrong = 0;
    for (std::uint32_t brick = 0; brick < pool.brickCount(); ++brick) {
      const SampleStore::Place place = store.place(brick);
      if (place.slot == 0) {
        samples.resize(store.slab(place.slab).bytes() / sizeof(Sample));
        transfer.download(store.slab(place.slab), std::as_writable_bytes(std::span(samples)));
      }
      // A voxel of the middle of each brick. One rounding of the scale, one of the product.
      const Sample& sample = samples[std::size_t{place.slot} * kBrickVoxels + (4 * 8 + 3) * 8 + 2];
      wrong +=
          std::abs(static_cast<double>(sample.gradient_i) * testLattice().spacing_m.x() / 3 - 1) > 1.2e-7 ? 1U : 0U;
    }
    EXPECT_EQ(wrong, 0U) << way;
  }
}

TEST_P(InParts, GradientsCanBeCancelled) {
  const Volume volume = ballField({20, 20, 20}, 6);
  gpu::Gpu gpu{{.tuned_as = deviceOf(GetParam())}};
  gpu::Transfer transfer(gpu);
  const BrickPool pool(gpu, transfer, volume);
  const SampleStore store(gpu, pool.brickCount(), allBricks(pool.grid()), makeGpuBudget());
  GradientPass pass(gpu, transfer, pool, store);
  EXPECT_THROW(pass.run([](double) { throw Error(Error::Code::kCancelled, "x", "y", "z"); }), Error);
  pass.run();  // and begun again
}

INSTANTIATE_TEST_SUITE_P(Devices, InParts, testing::ValuesIn(tunings().begin(), tunings().end()),
                         [](const auto& row) { return deviceOf(row.param); });

}  // namespace submission_parts_test
}  // namespace palpate
