// SPDX-License-Identifier: Apache-2.0
// Kernels that read a pool of one to eight slabs. A pool that is full to the last slab would hold 1 GiB of densities;
// here only a patch of bricks is filled, whose slots lie in every slab.
#include "engine/passes/pool_kernel.hpp"

#include <cstring>
#include <optional>
#include <span>

#include <gtest/gtest.h>

#include "engine/passes/gradient_pass.hpp"
#include "engine/passes/window_pass.hpp"
#include "engine/reference/window.hpp"
#include "test_fields.hpp"
#include "tests/engine/passes/sample_bits.hpp"

namespace palpate {
namespace pool_kernel_test {

// 256 x 512 x 4 bricks: where all are stored in order, the half below brick row 256 of layer z is slab 2z, the other
// half slab 2z + 1. A window around row 256 that is as deep as the domain lies in all eight.
const Vec3i kDomain(2048, 4096, 32);
const WindowBox kWindow{{800, 2032, 0}, {32, 32, 32}};
// The window and a brick more on each side, except where the domain ends: all that its gradients read.
const Vec3i kPatchFirst(792, 2024, 0), kPatchSize(48, 48, 32);
constexpr float kElsewhere = 7;  // density of the bricks that are not stored

class Slabs : public testing::Test {
 protected:
  static Volume flat(float density) {
    return Volume::fromBricks(kDomain, testLattice(), {}, [density](const Vec3i&, float* values) {
      values[0] = density;
      return true;
    });
  }
  // Differs from voxel to voxel and from brick to brick.
  static float density(const Vec3i& voxel) {
    return static_cast<float>((voxel.x() * 73 + voxel.y() * 151 + voxel.z() * 283) % 1009);
  }
  static std::size_t slabOf(std::size_t brick) { return brick / BRICKS_PER_DENSITY_SLAB; }

  // Stores all bricks of the first `count` slabs, more than before.
  void storeSlabs(std::size_t count) {
    std::vector<layout::BrickPage> pages(pool_.brickCount(), {NO_SLOT, kElsewhere});
    for (std::size_t brick = 0; slabOf(brick) < count; ++brick) pages[brick] = {0, 0};
    pool_.assign(transfer_, std::move(pages));
    const BrickGrid grid = pool_.grid();
    grid.forEachIn({kPatchFirst, kPatchFirst + kPatchSize - Vec3i::Ones()}, [&](const Vec3i& at) {
      const std::uint32_t brick = grid.index(at);
      if (slabOf(brick) < stored_slabs_ || slabOf(brick) >= count) return;
      std::vector<float> values;
      for (int n = 0; n < kBrickVoxels; ++n) values.push_back(density(at * 8 + Vec3i(n % 8, n / 8 % 8, n / 64)));
      const BrickPool::Place place = BrickPool::place(pool_.page(brick).slot);
      ASSERT_EQ(place.slab, slabOf(brick));
      transfer_.upload(std::as_bytes(std::span(values)), pool_.slab(place.slab), place.offset_bytes);
    });
    stored_slabs_ = count;
  }

  // The samples of the window, from the given gradients.
  std::vector<Sample> gathered(GradientPass& gradient) {
    gradient.run();
    window_.run(kWindow, box_);
    std::vector<Sample> samples(std::size_t{32} * 32 * 32);
    std::memcpy(samples.data(), box_.mapped(), box_.bytes());
    return samples;
  }
  // The same by the twin, of the patch alone. The patch ends where the domain ends, or a brick beyond the window.
  std::vector<Sample> expected(std::size_t count) const {
    const BrickGrid grid = pool_.grid();
    const Volume patch = makeField(kPatchSize, [&](int i, int j, int k) {
      const Vec3i voxel = kPatchFirst + Vec3i(i, j, k);
      return slabOf(grid.index(voxel / 8)) < count ? density(voxel) : kElsewhere;
    });
    return reference::windowSamples(reference::denseField(patch), kWindow.first - kPatchFirst, kWindow.size);
  }
  static std::size_t differing(const std::vector<Sample>& got, const std::vector<Sample>& want) {
    std::size_t count = 0;
    for (std::size_t n = 0; n < want.size(); ++n) count += sameBits(got[n], want[n]) ? 0 : 1;
    return count;
  }
  std::vector<std::uint32_t> windowBricks() const {
    std::vector<std::uint32_t> bricks;
    pool_.grid().forEachIn({kWindow.first, kWindow.first + kWindow.size - Vec3i::Ones()},
                           [&](const Vec3i& at) { bricks.push_back(pool_.grid().index(at)); });
    return bricks;
  }

  gpu::Gpu gpu_{{}};
  gpu::Transfer transfer_{gpu_};
  BrickPool flat_{gpu_, transfer_, flat(kElsewhere)};
  BrickPool pool_{gpu_, transfer_, flat_, "slabs"};
  SampleStore store_{gpu_, pool_.brickCount(), windowBricks()};
  WindowPass window_{gpu_, flat_, store_};  // all its bricks have samples: it reads no pool
  std::size_t stored_slabs_ = 0;
  gpu::Buffer box_{gpu_, "window", std::size_t{32} * 32 * 32 * sizeof(Sample), gpu::MemoryKind::kHost};
};

// The gradient kernel reads quads and single elements of all slabs that there are; for another number of slabs it is
// built anew, which takes lavapipe some two seconds: so not every number is tried. The smoothed one takes either from a
// pool of its own: here one of the two pools has eight slabs, the other one.
TEST_F(Slabs, EachIsReadWhereItLies) {
  GradientPass gradient(gpu_, transfer_, pool_, store_);
  for (const std::size_t count : {std::size_t{3}, std::size_t{DENSITY_SLABS}}) {
    storeSlabs(count);
    ASSERT_EQ(pool_.slabCount(), count);
    EXPECT_EQ(differing(gathered(gradient), expected(count)), 0U) << count << " slabs";
  }

  const std::vector<Sample> whole = expected(DENSITY_SLABS);
  std::vector<Sample> gradients = whole, densities = whole;
  for (Sample& sample : gradients) sample.density = kElsewhere;
  for (Sample& sample : densities) sample = {0, 0, 0, sample.density};
  GradientPass smoothed_by_eight(gpu_, transfer_, flat_, store_, {}, &pool_);
  EXPECT_EQ(differing(gathered(smoothed_by_eight), gradients), 0U);
  GradientPass densities_of_eight(gpu_, transfer_, pool_, store_, {}, &flat_);
  EXPECT_EQ(differing(gathered(densities_of_eight), densities), 0U);
}

}  // namespace pool_kernel_test
}  // namespace palpate
