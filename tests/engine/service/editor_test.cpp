// SPDX-License-Identifier: Apache-2.0
// Edits on the GPU against three truths: the twin, a new start from the volume that was read back, and formulas.
#include "engine/service/editor.hpp"

#include <bit>
#include <cstring>

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "engine/passes/active_bricks.hpp"
#include "engine/reference/edit.hpp"
#include "random_edits.hpp"
#include "servo/window/sample_window.hpp"

namespace palpate {
namespace {

Lattice lattice() {
  Lattice lattice;
  lattice.origin_W = {0.01, -0.02, 0.03};
  lattice.spacing_m = {0.7e-3, 0.9e-3, 1.3e-3};
  lattice.R_WL = Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized()).matrix();
  return lattice;
}

// A ball with a ramp in empty space, values -100 to 200, isovalue 30: constant bricks inside and outside.
Volume ball(const Vec3i& size, double radius_voxels) {
  std::vector<float> values;
  const Vec3 middle = (size.cast<double>().array() - 1) / 2;
  for (int k = 0; k < size.z(); ++k) {
    for (int j = 0; j < size.y(); ++j) {
      for (int i = 0; i < size.x(); ++i) {
        const double inside = radius_voxels - (Vec3(i, j, k) - middle).norm();
        values.push_back(static_cast<float>(std::clamp(30 + 40 * inside, -100.0, 200.0)));
      }
    }
  }
  return Volume::fromDense(size, lattice(), values, {});
}
constexpr double kIsovalue = 30;

// All that the engine keeps of a volume.
struct State {
  gpu::Transfer transfer;
  BrickPool pool;
  BrickBoundsPass bounds;
  SampleStore store;
  GradientPass gradient;
  WindowPass window;

  State(gpu::Gpu& gpu, const Volume& volume, bool all, std::uint64_t budget = 0, bool in_place = true)
      : transfer(gpu, in_place),
        pool(gpu, transfer, volume, makeGpuBudget(budget)),
        bounds(gpu, pool),
        store(gpu, pool.brickCount(), firstBricks(all), pool.budget()),
        gradient(gpu, transfer, pool, store),
        window(gpu, pool, store) {
    gradient.run();
  }
  std::vector<std::uint32_t> firstBricks(bool all) {
    bounds.run();
    return all ? allBricks(pool.brickCounts())
               : activeBricks(bounds.read(transfer), pool.brickCounts(), static_cast<float>(kIsovalue));
  }
  Editor::Parts parts(gpu::Gpu& gpu) { return {gpu, transfer, pool, store, &bounds, gradient, window}; }

  std::vector<float> brick(std::size_t b) {
    std::vector<float> values(kBrickVoxels);
    if (pool.readBrick(transfer, b, values.data())) values.assign(kBrickVoxels, values[0]);
    return values;
  }
  std::vector<Sample> samples(std::size_t b) {
    std::vector<Sample> samples(kBrickVoxels);
    const SampleStore::Place at = store.place(b);
    transfer.download(store.slab(at.slab), std::as_writable_bytes(std::span(samples)),
                      std::size_t{at.slot} * kBrickVoxels * sizeof(Sample));
    return samples;
  }
};

template <typename T>
bool sameBytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

BrushProfile profileOf(const Volume& volume) {
  return brushProfile(kIsovalue, -100, 200, volume.lattice().spacing_m);
}

// Bricks, storage, bounds, active set and samples of two states.
void expectSame(State& got, State& want) {
  EXPECT_EQ(got.pool.storedBricks(), want.pool.storedBricks());
  EXPECT_TRUE(sameBytes(got.bounds.read(got.transfer), want.bounds.read(want.transfer)));
  EXPECT_EQ(got.store.bricks(), want.store.bricks());
  std::size_t densities = 0;
  std::size_t samples = 0;
  for (std::size_t b = 0; b < got.pool.brickCount(); ++b) {
    densities += sameBytes(got.brick(b), want.brick(b)) ? 0 : 1;
    if (got.store.has(b) && want.store.has(b)) samples += sameBytes(got.samples(b), want.samples(b)) ? 0 : 1;
  }
  EXPECT_EQ(densities, 0U) << "bricks whose densities differ";
  EXPECT_EQ(samples, 0U) << "bricks whose samples differ";
}

struct Case {
  Vec3i size;
  bool all = false;
  unsigned seed = 1;
  int edits = 1000;
  bool in_place = true;
};

class ManyEdits : public testing::TestWithParam<Case> {};

// The twin works on plain arrays and has its own way through the volume; the new start knows nothing of the past.
TEST_P(ManyEdits, EqualTheTwinAndANewStart) {
  const Case c = GetParam();
  Volume volume = ball(c.size, 0.3 * c.size.minCoeff());
  gpu::Gpu gpu({});
  State state(gpu, volume, c.all, 0, c.in_place);
  const BrushProfile profile = profileOf(volume);
  Editor editor(state.parts(gpu), profile, c.all);
  reference::DenseField twin = reference::denseField(volume);
  RandomEdits random(c.size, volume.lattice(), -120, 220, c.seed);
  for (int done = 0, round = 1; done < c.edits; ++round) {
    std::vector<EditCommand> commands;
    do commands.push_back(random.next());
    while (random.pick(3) == 0);
    if (random.pick(5) == 0) commands.push_back(mirrored(commands.back(), random.place(), Vec3(1, 0.2, 0)));
    std::erase_if(commands, [&](const EditCommand& command) {
      try {
        checkEdit(command, c.size, volume.lattice());
        return false;
      } catch (const Error&) {  // a mirror may throw a place far out
        return true;
      }
    });
    if (commands.empty()) continue;
    done += static_cast<int>(commands.size());
    const Editor::Outcome outcome = editor.apply(commands, nullptr);
    editor.settle();
    EXPECT_EQ(outcome.version, editor.version());
    reference::applyEdits(twin, lowerEdits(commands, c.size, volume.lattice(), profile));
    if (round % 40 != 0 && done < c.edits) continue;
    editor.readBack(volume);
    ASSERT_TRUE(sameBytes(volume.toDense(), twin.values)) << "after " << done << " edits";
    State fresh(gpu, volume, c.all);
    expectSame(state, fresh);
    ASSERT_FALSE(testing::Test::HasFailure()) << "after " << done << " edits";
  }
  EXPECT_EQ(editor.readBack(volume), 0U);
}

INSTANTIATE_TEST_SUITE_P(Cases, ManyEdits,
                         testing::Values(Case{{53, 41, 37}, false, 1, 1000}, Case{{33, 24, 50}, true, 2, 200},
                                         Case{{17, 9, 2}, false, 3, 200}, Case{{64, 64, 64}, false, 4, 200}));

}  // namespace
}  // namespace palpate
