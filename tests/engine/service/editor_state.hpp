// SPDX-License-Identifier: Apache-2.0
// tests/engine/service/editor_state.hpp: a volume with all that the engine keeps of it, and a comparison of two such
// states, for tests of Editor.
#pragma once

#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "engine/bricks/active_bricks.hpp"
#include "engine/edit/edit_command.hpp"
#include "engine/service/editor.hpp"

namespace palpate {

inline Lattice lattice() {
  Lattice lattice;
  lattice.origin_W = {0.01, -0.02, 0.03};
  lattice.spacing_m = {0.7e-3, 0.9e-3, 1.3e-3};
  lattice.R_WL = Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized()).matrix();
  return lattice;
}

// A ball with a ramp in empty space, values -100 to 200, isovalue 30: constant bricks inside and outside.
inline Volume ball(const Vec3i& size, double radius_voxels) {
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
inline constexpr double kIsovalue = 30;

// All that the engine keeps of a volume.
struct State {
  gpu::Transfer transfer;
  BrickPool pool;
  float isovalue = static_cast<float>(kIsovalue);  // of the field
  std::unique_ptr<FilterChain> filters;
  const BrickPool& field;  // the field that is felt: filtered, if there are filters
  BrickBoundsPass bounds;
  SampleStore store;
  std::unique_ptr<FilterChain> smoothing;  // for an operator that smooths
  GradientPass gradient;
  WindowPass window;

  State(gpu::Gpu& gpu, const Volume& volume, bool all, std::uint64_t budget = 0, bool in_place = true,
        const char* chain = "", const GradientOperator& gradient_operator = {}, const SampleFormat& format = {})
      : transfer(gpu, in_place),
        pool(gpu, transfer, volume, makeGpuBudget(budget)),
        filters(filtersOf(gpu, chain)),
        field(filters ? filters->result() : pool),
        bounds(gpu, field),
        store(gpu, pool.brickCount(), firstBricks(all), pool.budget(), format),
        smoothing(smoothingOf(gpu, gradient_operator)),
        gradient(gpu, transfer, field, store, gradient_operator, smoothing ? &smoothing->result() : nullptr),
        window(gpu, field, store) {
    gradient.run();
  }
  std::unique_ptr<FilterChain> filtersOf(gpu::Gpu& gpu, const char* chain) {
    if (*chain == '\0') return nullptr;
    const std::vector<FilterSpec> filter_list = filterChain(chain);
    auto made =
        std::make_unique<FilterChain>(gpu, transfer, pool, lowerFilters(filter_list, lattice().spacing_m, isovalue));
    made->run();
    isovalue = isovalueAfter(filter_list, isovalue);
    return made;
  }
  std::unique_ptr<FilterChain> smoothingOf(gpu::Gpu& gpu, const GradientOperator& gradient_operator) {
    if (!gradient_operator.smooths()) return nullptr;
    auto made = std::make_unique<FilterChain>(gpu, transfer, field,
                                              lowerFilters(gradient_operator.smoothing, lattice().spacing_m));
    made->run();
    return made;
  }
  std::vector<std::uint32_t> firstBricks(bool all) {
    bounds.run();
    return all ? allBricks(pool.grid()) : activeBricks(bounds.read(transfer), pool.grid(), isovalue);
  }
  Editor::Parts parts(gpu::Gpu& gpu) {
    return {gpu, transfer, pool, store, &bounds, gradient, window, filters.get(), isovalue, smoothing.get()};
  }

  std::vector<float> brick(const BrickPool& of, std::size_t b) {
    std::vector<float> values(kBrickVoxels);
    if (of.readBrick(transfer, b, values.data())) values.assign(kBrickVoxels, values[0]);
    return values;
  }
  std::vector<std::byte> samples(std::size_t b) {  // as they are stored
    std::vector<std::byte> samples(kBrickVoxels * store.format().bytesAVoxel());
    const SampleStore::Place at = store.place(b);
    transfer.download(store.slab(at.slab), samples, at.slot * samples.size());
    return samples;
  }
};

template <typename T>
bool sameBytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

inline BrushProfile profileOf(const Volume& volume) {
  return brushProfile(kIsovalue, -100, 200, volume.lattice().spacing_m);
}

// Compares the bricks, storage, bounds, active sets and samples of two states.
inline void expectSame(State& got, State& want) {
  EXPECT_EQ(got.pool.storedBricks(), want.pool.storedBricks());
  // Filtered bricks that a change did not reach may have kept their one density without storage.
  const auto expectNearlyAsSparse = [](const BrickPool& a, const BrickPool& b) {
    const auto stored = static_cast<double>(b.storedBricks());
    EXPECT_NEAR(static_cast<double>(a.storedBricks()), stored, 0.1 * stored + 8);
  };
  const bool is_distance = got.isovalue != static_cast<float>(kIsovalue);
  if (got.filters && !is_distance) expectNearlyAsSparse(got.field, want.field);
  if (got.smoothing && !is_distance) expectNearlyAsSparse(got.smoothing->result(), want.smoothing->result());
  EXPECT_TRUE(sameBytes(got.bounds.read(got.transfer), want.bounds.read(want.transfer)));
  EXPECT_EQ(got.store.bricks(), want.store.bricks());
  std::size_t densities = 0;
  std::size_t samples = 0;
  std::size_t filtered = 0;
  std::size_t smoothed = 0;
  for (std::size_t b = 0; b < got.pool.brickCount(); ++b) {
    densities += sameBytes(got.brick(got.pool, b), want.brick(want.pool, b)) ? 0 : 1;
    filtered += sameBytes(got.brick(got.field, b), want.brick(want.field, b)) ? 0 : 1;
    if (got.smoothing) {
      const auto of = [b](State& state) { return state.brick(state.smoothing->result(), b); };
      smoothed += sameBytes(of(got), of(want)) ? 0 : 1;
    }
    if (got.store.has(b) && want.store.has(b)) samples += sameBytes(got.samples(b), want.samples(b)) ? 0 : 1;
  }
  EXPECT_EQ(densities, 0U) << "bricks whose densities differ";
  EXPECT_EQ(filtered, 0U) << "bricks whose filtered densities differ";
  EXPECT_EQ(smoothed, 0U) << "bricks whose smoothed densities differ";
  EXPECT_EQ(samples, 0U) << "bricks whose samples differ";
}

// Variants that tests run with: the volume's own gradients, those of a smoothed field, and those of a filtered field.
struct Field {
  const char* chain;
  const char* gradient_operator;
};
class EveryField : public testing::TestWithParam<Field> {
 protected:
  GradientOperator gradient_operator_ = gradientOperator(GetParam().gradient_operator);
  const char* chain_ = GetParam().chain;
};

// With and without filters and smoothing: the parameters of EveryField and of the fixtures derived from it.
inline auto everyField() {
  return testing::Values(Field{"", "central"}, Field{"", "gaussian:1.5"}, Field{"gaussian:0.8", "gaussian:1"});
}

inline EditCommand brush(EditKind kind, const Volume& volume, const Vec3& p_L, double radius_m) {
  EditCommand command;
  command.kind = kind;
  command.from_W = command.to_W = volume.lattice().toWorld(p_L);
  command.radius_m = radius_m;
  return command;
}

}  // namespace palpate
