// SPDX-License-Identifier: Apache-2.0
// Edits on the GPU against three truths: the twin, a new start from the volume that was read back, and formulas.
#include "engine/service/editor.hpp"

#include <bit>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <set>

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "engine/edit/random_edits.hpp"
#include "engine/passes/active_bricks.hpp"
#include "engine/reference/edit.hpp"
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
  float isovalue = static_cast<float>(kIsovalue);  // of the field
  std::unique_ptr<FilterChain> filters;
  const BrickPool& field;  // that is felt: the filtered one, if there are filters
  BrickBoundsPass bounds;
  SampleStore store;
  std::unique_ptr<FilterChain> smoothing;  // for an operator that smooths
  GradientPass gradient;
  WindowPass window;

  State(gpu::Gpu& gpu, const Volume& volume, bool all, std::uint64_t budget = 0, bool in_place = true,
        const char* chain = "", const GradientOperator& way = {}, const SampleFormat& format = {})
      : transfer(gpu, in_place),
        pool(gpu, transfer, volume, makeGpuBudget(budget)),
        filters(filtersOf(gpu, chain)),
        field(filters ? filters->result() : pool),
        bounds(gpu, field),
        store(gpu, pool.brickCount(), firstBricks(all), pool.budget(), format),
        smoothing(smoothingOf(gpu, way)),
        gradient(gpu, transfer, field, store, way, smoothing ? &smoothing->result() : nullptr),
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
  std::unique_ptr<FilterChain> smoothingOf(gpu::Gpu& gpu, const GradientOperator& way) {
    if (!way.smooths()) return nullptr;
    auto made = std::make_unique<FilterChain>(gpu, transfer, field, lowerFilters(way.smoothing, lattice().spacing_m));
    made->run();
    return made;
  }
  std::vector<std::uint32_t> firstBricks(bool all) {
    bounds.run();
    return all ? allBricks(pool.brickCounts()) : activeBricks(bounds.read(transfer), pool.brickCounts(), isovalue);
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

BrushProfile profileOf(const Volume& volume) {
  return brushProfile(kIsovalue, -100, 200, volume.lattice().spacing_m);
}

// Bricks, storage, bounds, active set and samples of two states.
void expectSame(State& got, State& want) {
  EXPECT_EQ(got.pool.storedBricks(), want.pool.storedBricks());
  // Of filtered bricks that a change did not reach, some may have kept their one density without storage.
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

struct Case {
  Vec3i size;
  bool all = false;
  unsigned seed = 1;
  int edits = 1000;
  bool in_place = true;
  const char* chain = "";
  const char* way = "central";
  bool half = false;
};

class ManyEdits : public testing::TestWithParam<Case> {};

// The twin works on plain arrays and has its own way through the volume; the new start knows nothing of the past.
TEST_P(ManyEdits, EqualTheTwinAndANewStart) {
  const Case c = GetParam();
  Volume volume = ball(c.size, 0.3 * c.size.minCoeff());
  gpu::Gpu gpu({});
  const GradientOperator way = gradientOperator(c.way);
  const SampleFormat format = c.half ? halfSamples(kIsovalue, -100, 200, volume.lattice().spacing_m) : SampleFormat{};
  State state(gpu, volume, c.all, 0, c.in_place, c.chain, way, format);
  const BrushProfile profile = profileOf(volume);
  Editor editor(state.parts(gpu), profile, c.all);
  reference::DenseField twin = reference::denseField(volume);
  RandomEdits random(c.size, volume.lattice(), -120, 220, c.seed);
  std::size_t most_stored = 0;
  std::size_t most_constant = 0;
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
    most_stored = std::max(most_stored, volume.storedBricks());
    most_constant = std::max(most_constant, state.pool.brickCount() - volume.storedBricks());
    State fresh(gpu, volume, c.all, 0, true, c.chain, way, format);
    expectSame(state, fresh);
    ASSERT_FALSE(testing::Test::HasFailure()) << "after " << done << " edits";
  }
  EXPECT_EQ(editor.readBack(volume), 0U);
  EXPECT_GE(most_stored, 2U);  // there was something to compare, and bricks came and went
  EXPECT_GE(most_constant, c.size.minCoeff() > 30 ? 2U : 0U);
}

INSTANTIATE_TEST_SUITE_P(Cases, ManyEdits,
                         testing::Values(Case{{53, 41, 37}, false, 1, 1000}, Case{{33, 24, 50}, true, 2, 200},
                                         Case{{17, 9, 2}, false, 3, 200}, Case{{64, 64, 64}, false, 4, 200},
                                         Case{{40, 40, 40}, false, 5, 200, false},
                                         Case{{53, 41, 37}, false, 6, 300, true, "", "sobel"},
                                         Case{{53, 41, 37}, false, 7, 300, true, "", "central4", true},
                                         Case{{33, 24, 50}, true, 8, 120, true, "", "central4"},
                                         Case{{33, 24, 50}, false, 9, 120, true, "", "sobel", true}));

// A filtered field follows edits of what it is made from.
INSTANTIATE_TEST_SUITE_P(
    Filtered, ManyEdits,
    testing::Values(Case{{53, 41, 37}, false, 6, 1000, true, "gaussian:1.2"},
                    Case{{64, 64, 64}, false, 7, 200, true, "gaussian:0.8mm gaussian:2:border=mirror"},
                    Case{{33, 24, 50}, true, 8, 200, false, "gaussian:3"},
                    Case{{53, 41, 37}, false, 9, 200, true, "diffuse:2:kappa=100"},
                    Case{{41, 33, 37}, false, 10, 200, true, "distance:2"},
                    Case{{41, 33, 37}, false, 11, 200, true, "gaussian:0.7 distance:1 gaussian:0.7"},
                    Case{{33, 24, 30}, true, 12, 100, false, "bilateral:0.7:range=80"},
                    Case{{41, 35, 38}, false, 9, 100, true, "median:1 close:2 gaussian:1"},
                    Case{{40, 33, 42}, false, 10, 60, true, "open:1.5:shape=ball median:2"},
                    Case{{53, 41, 37}, false, 10, 200, true, "gaussian:1.2", "central4", true}));

// So does the smoothed field of an operator that takes its gradient, behind a filter or not.
INSTANTIATE_TEST_SUITE_P(
    Smoothed, ManyEdits,
    testing::Values(Case{{53, 41, 37}, false, 12, 600, true, "", "gaussian:1"},
                    Case{{53, 41, 37}, false, 13, 200, true, "gaussian:1.2", "gaussian:0.8mm", true},
                    Case{{33, 24, 50}, true, 14, 120, false, "", "gaussian:2:border=mirror"},
                    Case{{64, 64, 64}, false, 15, 150, true, "", "gaussian:3"},  // reaches two bricks far
                    Case{{17, 9, 1}, false, 16, 150, true, "", "gaussian:1.5mm", true},
                    Case{{41, 33, 37}, false, 17, 120, true, "distance:2", "gaussian:1"},
                    Case{{41, 35, 38}, false, 18, 80, true, "median:1 close:2", "gaussian:1:truncate=4", true}));

// What the tests below are run with: the volume's own gradients, those of a smoothed field, and that behind a filter.
struct Field {
  const char* chain;
  const char* way;
};
class EveryField : public testing::TestWithParam<Field> {
 protected:
  GradientOperator way_ = gradientOperator(GetParam().way);
  const char* chain_ = GetParam().chain;
};
INSTANTIATE_TEST_SUITE_P(Fields, EveryField,
                         testing::Values(Field{"", "central"}, Field{"", "gaussian:1.5"},
                                         Field{"gaussian:0.8", "gaussian:1"}));

EditCommand brush(EditKind kind, const Volume& volume, const Vec3& p_L, double radius_m) {
  EditCommand command;
  command.kind = kind;
  command.from_W = command.to_W = volume.lattice().toWorld(p_L);
  command.radius_m = radius_m;
  return command;
}

// Every kind's kernel runs once before the first edit and changes nothing.
TEST(Editor, MakesKernelsReadyWithoutChangingAnything) {
  Volume volume = ball({40, 40, 40}, 12);
  gpu::Gpu gpu({});
  State state(gpu, volume, false);
  Editor editor(state.parts(gpu), profileOf(volume), false);
  std::vector<EditKind> kinds;
  for (int kind = 0; kind < 10; ++kind) kinds.push_back(static_cast<EditKind>(kind));
  editor.prepare(kinds);
  EXPECT_EQ(editor.version(), 0U);
  State fresh(gpu, volume, false);
  expectSame(state, fresh);
  EditCommand hole = brush(EditKind::kRemove, volume, {20, 20, 20}, 3e-3);
  EXPECT_GT(editor.apply(std::span(&hole, 1), nullptr).changed_bricks, 0U);
}

// A volume of one density has no storage; a hole makes some, and filling it up again frees all of it.
TEST(Editor, StoresWhatIsNotConstantAndFreesWhatBecomesSo) {
  const Vec3i size(64, 64, 64);
  Volume volume = Volume::fromBricks(size, lattice(), {}, [](const Vec3i& brick, float* values) {
    values[0] = brick.x() < 4 ? 200.0F : -100.0F;
    return true;
  });
  gpu::Gpu gpu({});
  State state(gpu, volume, false);
  Editor editor(state.parts(gpu), profileOf(volume), false);
  const std::size_t active = state.store.brickCount();
  EXPECT_EQ(state.pool.storedBricks(), 0U);

  EditCommand hole = brush(EditKind::kRemove, volume, {14, 30, 30}, 5e-3);
  editor.apply(std::span(&hole, 1), nullptr);
  editor.settle();
  EXPECT_GT(state.pool.storedBricks(), 8U);
  EXPECT_GT(state.store.brickCount(), active);
  EXPECT_GT(editor.readBack(volume), 8U);
  EXPECT_EQ(volume.storedBricks(), state.pool.storedBricks());

  EditCommand fill = brush(EditKind::kPaint, volume, {14, 30, 30}, 20e-3);
  fill.value = 200;
  editor.apply(std::span(&fill, 1), nullptr);
  editor.settle();
  editor.readBack(volume);
  State fresh(gpu, volume, false);
  expectSame(state, fresh);
  // All around the old hole is 200 again.
  EXPECT_EQ(volume.value({14, 30, 30}), 200);
}

// A brush reaches bricks that it leaves as they are, and what was taken back has changed nothing: counted against the
// volume, voxel by voxel.
TEST(Editor, ReadBackCountsTheBricksThatHoldSomethingElse) {
  const Vec3i size(53, 41, 37);
  Volume volume = ball(size, 12);
  gpu::Gpu gpu({});
  State state(gpu, volume, false);
  Editor editor(state.parts(gpu), profileOf(volume), false);
  const std::vector<EditCommand> dab = {brush(EditKind::kRemove, volume, {16, 20, 18}, 6e-3)};
  std::vector<BrickContent> kept;
  for (const std::uint32_t brick : editor.bricksToChange(dab)) kept.push_back(editor.content(brick));
  editor.apply(dab, nullptr);
  editor.settle();
  const std::size_t reached = editor.changedBricks();
  const std::vector<float> before = volume.toDense();
  const std::size_t counted = editor.readBack(volume);
  const std::vector<float> after = volume.toDense();
  std::set<std::uint32_t> changed;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const int n = static_cast<int>(i);
    const Vec3i voxel(n % size.x(), n / size.x() % size.y(), n / size.x() / size.y());
    if (std::bit_cast<std::uint32_t>(before[i]) != std::bit_cast<std::uint32_t>(after[i]))
      changed.insert(editor.grid().index(voxel / kBrickSize));
  }
  EXPECT_EQ(counted, changed.size());
  EXPECT_GT(counted, 0U);
  EXPECT_LT(counted, reached);
  editor.apply(dab, nullptr);  // once more changes nothing
  EXPECT_EQ(editor.readBack(volume), 0U);
  editor.replace(kept, nullptr);
  EXPECT_EQ(editor.readBack(volume), counted);
  EXPECT_EQ(volume.toDense(), before);
}

// The middle of a large brush in one density never needs storage, and brushes in the air touch nothing.
TEST(Editor, WorksOnlyWhereSomethingChanges) {
  const Vec3i size(96, 96, 96);
  Volume volume = Volume::fromBricks(size, lattice(), {}, [](const Vec3i& brick, float* values) {
    values[0] = brick.z() < 6 ? 200.0F : -100.0F;
    return true;
  });
  gpu::Gpu gpu({});
  State state(gpu, volume, false);
  Editor editor(state.parts(gpu), profileOf(volume), false);
  EditCommand air = brush(EditKind::kRemove, volume, {40, 40, 80}, 10e-3);
  const Editor::Outcome nothing = editor.apply(std::span(&air, 1), nullptr);
  EXPECT_EQ(nothing.changed_bricks, 0U);
  EXPECT_EQ(nothing.version, 1U);
  EXPECT_EQ(editor.changedBricks(), 0U);

  EditCommand cut;
  cut.kind = EditKind::kCut;
  cut.plane_W = volume.lattice().toWorld({20.5, 0, 0});
  cut.normal_W = volume.lattice().R_WL.col(0);
  editor.apply(std::span(&cut, 1), nullptr);
  editor.settle();
  // One layer of bricks carries the ramp, or two; all beyond became constant without storage.
  EXPECT_LE(state.pool.storedBricks(), 2U * 12U * 12U);
  editor.readBack(volume);
  EXPECT_EQ(volume.value({90, 5, 5}), -100);
  State fresh(gpu, volume, false);
  expectSame(state, fresh);
}

// A budget that holds the start but not a large brush: an error that says so, and everything is as it was; a small
// brush still works.
TEST(Editor, RefusesWhatExceedsTheBudgetAndGoesOn) {
  const Vec3i size(96, 96, 96);
  Volume volume = ball(size, 30);
  gpu::Gpu gpu({});
  State probe(gpu, volume, false);
  // What an editor needs at its start, and one MiB.
  Editor probing(probe.parts(gpu), profileOf(volume), false);
  const std::uint64_t budget = probe.pool.budget()->used_bytes + (std::uint64_t{1} << 20U);

  State state(gpu, volume, false, budget);
  Editor editor(state.parts(gpu), profileOf(volume), false);
  EditCommand large = brush(EditKind::kSmooth, volume, {48, 48, 48}, 35e-3);
  EditCommand larger = brush(EditKind::kInflate, volume, {48, 48, 48}, 40e-3);
  EditCommand paint = brush(EditKind::kAdd, volume, {48, 48, 48}, 38e-3);
  paint.falloff = 1;
  paint.strength = 0.5;
  const std::vector<EditCommand> commands = {large, paint, larger};
  try {
    editor.apply(commands, nullptr);
    FAIL() << "it fitted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::Code::kOutOfMemory);
    EXPECT_NE(std::string(error.what()).find("nothing was changed"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("--gpu-memory"), std::string::npos) << error.what();
    // What is there, what the edit needs of either kind, the budget; and the sum, rounded up, is enough.
    double used = 0, wanted = 0, densities = 0, samples = 0, limit = 0;
    ASSERT_EQ(std::sscanf(error.reason().c_str(),
                          "the volume, as edited until now, takes %lf MiB, the edit needs %lf MiB more (%lf MiB for "
                          "densities, %lf MiB for samples), and the budget is %lf MiB",
                          &used, &wanted, &densities, &samples, &limit),
              5)
        << error.what();
    EXPECT_NEAR(limit * 1048576, static_cast<double>(budget), 0.05 * 1048576);  // one decimal
    EXPECT_GT(used + wanted, limit);
    EXPECT_NEAR(densities + samples, wanted, 0.15);  // three of one decimal
    const auto enough = static_cast<std::uint64_t>(std::ceil(used + wanted + 0.1)) << 20U;
    EXPECT_NE(error.remedy().find("raise --gpu-memory to "), std::string::npos) << error.what();
    State roomy(gpu, volume, false, enough);
    Editor other(roomy.parts(gpu), profileOf(volume), false);
    EXPECT_NO_THROW(other.apply(commands, nullptr));
  }
  EXPECT_EQ(editor.version(), 0U);
  EXPECT_EQ(editor.changedBricks(), 0U);
  State fresh(gpu, volume, false);
  expectSame(state, fresh);
  EditCommand small = brush(EditKind::kRemove, volume, {48, 48, 20}, 3e-3);
  editor.apply(std::span(&small, 1), nullptr);
  editor.settle();
  editor.readBack(volume);
  State after(gpu, volume, false);
  expectSame(state, after);
}

// "samples" of "GPU memory for samples: ...".
std::string poolIn(const Error& error) {
  const std::string text = error.what();
  const std::size_t first = text.find("for ") + 4;
  return text.substr(first, text.find(':') - first);
}

// Wherever room runs out, nothing has changed, and what fits goes on.
TEST_P(EveryField, IsAsItWasWhicheverPoolHasNoRoom) {
  if (!way_.smooths()) return;  // RefusesWhatExceedsTheBudgetAndGoesOn
  const auto volumeOf = [] { return ball({48, 40, 56}, 10); };
  const Volume volume = volumeOf();
  gpu::Gpu gpu({});
  const auto used = [&] {
    State probe(gpu, volume, false, 0, true, chain_, way_);
    const Editor editor(probe.parts(gpu), profileOf(volume), false);
    return probe.pool.budget()->used_bytes;
  }();
  const std::vector<EditCommand> large = {brush(EditKind::kSmooth, volume, {24, 20, 28}, 16e-3),
                                          brush(EditKind::kInflate, volume, {24, 20, 28}, 18e-3)};
  const EditCommand small = brush(EditKind::kRemove, volume, {24, 20, 28}, 2e-3);
  std::set<std::string> full;
  int went_on = 0;
  for (std::uint64_t more = 0;; more += std::uint64_t{1} << 19U) {
    State state(gpu, volume, false, used + more, true, chain_, way_);
    Editor editor(state.parts(gpu), profileOf(volume), false);
    Volume edited = volumeOf();
    // Whether it fitted; if not, everything is as it was.
    const auto fits = [&](std::span<const EditCommand> commands) {
      try {
        editor.apply(commands, nullptr);
        return true;
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), Error::Code::kOutOfMemory);
        EXPECT_NE(std::string(error.what()).find("nothing was changed"), std::string::npos) << error.what();
        full.insert(poolIn(error));
        EXPECT_EQ(editor.version(), 0U);
        return false;
      }
    };
    const bool all = fits(large);
    went_on += !all && fits(std::span(&small, 1)) ? 1 : 0;
    editor.settle();
    editor.readBack(edited);
    State fresh(gpu, edited, false, 0, true, chain_, way_);
    expectSame(state, fresh);
    ASSERT_FALSE(testing::Test::HasFailure()) << more;
    if (all) break;
  }
  EXPECT_GE(went_on, 1);
  EXPECT_TRUE(full.contains("filter scratch"));
}

// With its mirror image a stamp takes its place once, so one that fills a binding fits; a larger one does not.
TEST(Editor, RefusesAStampThatOneBindingDoesNotHold) {
  Volume volume = ball({40, 40, 40}, 12);
  gpu::Gpu gpu({});
  const std::uint64_t most = gpu.info().max_binding_bytes / sizeof(float);
  if (most > std::uint64_t{1} << 26U) GTEST_SKIP() << "this device binds more than a test should fill";
  State state(gpu, volume, false);
  Editor editor(state.parts(gpu), profileOf(volume), false);
  const auto stampOf = [](int depth) {
    auto stamp = std::make_shared<Stamp>();
    stamp->size = {512, 512, depth};
    stamp->lattice.spacing_m = Vec3::Constant(5e-5);
    stamp->distance_m.assign(static_cast<std::size_t>(stamp->size.prod()), -1.0F);
    return stamp;
  };
  const int deepest = static_cast<int>(most / (512U * 512U));
  std::vector<EditCommand> commands = {brush(EditKind::kStampRemove, volume, {5, 5, 5}, 0)};
  commands[0].stamp = stampOf(deepest);
  commands.push_back(mirrored(commands[0], volume.lattice().toWorld({20, 20, 20}), volume.lattice().R_WL.col(0)));
  EXPECT_GT(editor.apply(commands, nullptr).changed_bricks, 8U);
  editor.settle();
  commands = {brush(EditKind::kStampAdd, volume, {5, 5, 5}, 0)};
  commands[0].stamp = stampOf(deepest + 1);
  try {
    editor.apply(commands, nullptr);
    FAIL() << "it fitted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::Code::kOutOfMemory);
    EXPECT_NE(std::string(error.what()).find("nothing was changed"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("smaller brush or stamp"), std::string::npos) << error.what();
  }
  EXPECT_EQ(editor.version(), 1U);
}

// The volume fits and nothing beside it: it can be felt, and an edit that needs room says that there is none.
TEST(Editor, StartsWithoutSpareRoomWhereTheBudgetHasNone) {
  Volume volume = ball({64, 64, 64}, 20);
  gpu::Gpu gpu({});
  State probe(gpu, volume, false);
  State state(gpu, volume, false, probe.pool.budget()->used_bytes);
  ASSERT_EQ(state.pool.budget()->leftBytes(), 0U);
  Editor editor(state.parts(gpu), profileOf(volume), false);
  EditCommand far = brush(EditKind::kAdd, volume, {5, 5, 5}, 3e-3);
  EXPECT_THROW(editor.apply(std::span(&far, 1), nullptr), Error);
  EXPECT_EQ(editor.version(), 0U);
}

TEST(Editor, RefusesAStartThatExceedsTheBudget) {
  const Volume volume = ball({64, 64, 64}, 20);
  gpu::Gpu gpu({});
  try {
    State state(gpu, volume, false, 1U << 16U);
    FAIL() << "it fitted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::Code::kOutOfMemory);
  }
}

// A refused command among good ones: none of them is applied.
TEST(Editor, AppliesAllOrNothing) {
  Volume volume = ball({40, 40, 40}, 12);
  gpu::Gpu gpu({});
  State state(gpu, volume, false);
  Editor editor(state.parts(gpu), profileOf(volume), false);
  std::vector<EditCommand> commands = {brush(EditKind::kRemove, volume, {20, 20, 20}, 5e-3),
                                       brush(EditKind::kRemove, volume, {20, 20, 20}, -1)};
  EXPECT_THROW(editor.apply(commands, nullptr), Error);
  EXPECT_EQ(editor.version(), 0U);
  State fresh(gpu, volume, false);
  expectSame(state, fresh);
}

// The window that an edit gathers equals one that is gathered anew afterwards, zero gradients of inactive bricks
// included; an edit elsewhere leaves it alone.
TEST_P(EveryField, GathersTheWindowThatANewGatherGives) {
  Volume volume = ball({96, 64, 64}, 20);
  gpu::Gpu gpu({});
  State state(gpu, volume, false, 0, true, chain_, way_);
  Editor editor(state.parts(gpu), profileOf(volume), false);
  const WindowBox box{{25, 13, 17}, {32, 32, 32}};
  const std::size_t bytes = 32768 * sizeof(Sample);
  const gpu::Buffer first(gpu, "window", bytes, gpu::MemoryKind::kHost);
  const gpu::Buffer second(gpu, "window", bytes, gpu::MemoryKind::kHost);
  const gpu::Buffer anew(gpu, "window", bytes, gpu::MemoryKind::kHost);
  // Every other edit knows the window before it, and copies from that what stays.
  const gpu::Buffer* newest = &first;
  state.window.run(box, first);
  RandomEdits random(volume.size(), volume.lattice(), -120, 220, 9);
  int gathered = 0;
  for (int n = 0; n < 60; ++n) {
    EditCommand command = random.next();
    if (command.kind == EditKind::kCut) continue;
    command.radius_m = std::min(command.radius_m, 6e-3);
    const gpu::Buffer* next = newest == &first ? &second : &first;
    const Editor::WindowTarget target{box, next, gathered % 2 == 0 ? newest : nullptr};
    const Editor::Outcome outcome = editor.apply(std::span(&command, 1), &target);
    editor.settle();
    if (!outcome.window_gathered) continue;
    ++gathered;
    newest = next;
    state.window.run(box, anew);
    ASSERT_EQ(std::memcmp(newest->mapped(), anew.mapped(), bytes), 0) << editName(command.kind) << " at " << n;
  }
  EXPECT_GT(gathered, 15);
  EditCommand far = brush(EditKind::kPaint, volume, {88, 60, 60}, 3e-3);
  far.value = 100;
  const Editor::WindowTarget target{box, newest};
  EXPECT_FALSE(editor.apply(std::span(&far, 1), &target).window_gathered);
}

// The inside of a large object, painted and put back: bricks go from one density to another on the same side of the
// isovalue, far from any surface. They have no samples and get none; the window shows their new densities all the same.
TEST_P(EveryField, GathersDensitiesThatChangeFarFromTheSurface) {
  Volume volume = Volume::fromBricks({96, 96, 96}, lattice(), {}, [](const Vec3i& brick, float* values) {
    values[0] = brick.x() < 11 ? 200.0F : -100.0F;
    return true;
  });
  gpu::Gpu gpu({});
  State state(gpu, volume, false, 0, true, chain_, way_);
  Editor editor(state.parts(gpu), profileOf(volume), false);
  const WindowBox box{{25, 29, 33}, {32, 32, 32}};
  const std::size_t bytes = 32768 * sizeof(Sample);
  const gpu::Buffer first(gpu, "window", bytes, gpu::MemoryKind::kHost);
  const gpu::Buffer second(gpu, "window", bytes, gpu::MemoryKind::kHost);
  const gpu::Buffer anew(gpu, "window", bytes, gpu::MemoryKind::kHost);
  const auto middle = [](const gpu::Buffer& window) {
    return static_cast<const Sample*>(window.mapped())[(16 * 32 + 16) * 32 + 16].density;
  };
  state.window.run(box, first);
  ASSERT_EQ(middle(first), 200);
  EditCommand paint = brush(EditKind::kPaint, volume, {41, 45, 49}, 35e-3);
  paint.value = 150;
  std::vector<BrickContent> kept;
  for (const std::uint32_t brick : editor.bricksToChange(std::span(&paint, 1))) kept.push_back(editor.content(brick));

  const auto expectAsAnew = [&](const gpu::Buffer& window, const Editor::Outcome& outcome, float density) {
    EXPECT_TRUE(outcome.window_gathered);
    editor.settle();
    state.window.run(box, anew);
    EXPECT_EQ(std::memcmp(window.mapped(), anew.mapped(), bytes), 0);
    EXPECT_FLOAT_EQ(middle(window), density);  // a Gaussian's taps sum to one but for rounding
  };
  const Editor::WindowTarget painted{box, &second, &first};
  expectAsAnew(second, editor.apply(std::span(&paint, 1), &painted), 150);
  const Editor::WindowTarget undone{box, &first, &second};
  expectAsAnew(first, editor.replace(kept, &undone), 200);
}

// What undo makes constant again in the filtered field gives its storage back, as often as that is done.
TEST_P(EveryField, PutsBricksBackWhereNothingIsStored) {
  Volume volume = Volume::fromBricks({80, 72, 64}, lattice(), {}, [](const Vec3i&, float* values) {
    values[0] = 200;
    return true;
  });
  gpu::Gpu gpu({});
  State state(gpu, volume, false, 0, true, chain_, way_);
  State before(gpu, volume, false, 0, true, chain_, way_);
  Editor editor(state.parts(gpu), profileOf(volume), false);
  const EditCommand hole = brush(EditKind::kRemove, volume, {40, 36, 32}, 6e-3);
  std::vector<BrickContent> kept;
  for (const std::uint32_t brick : editor.bricksToChange(std::span(&hole, 1))) kept.push_back(editor.content(brick));
  for (int n = 0; n < 3; ++n) {
    editor.apply(std::span(&hole, 1), nullptr);
    editor.settle();
    ASSERT_GT(state.field.storedBricks(), 8U);
    editor.replace(kept, nullptr);
    editor.settle();
    EXPECT_EQ(state.pool.storedBricks(), 0U);
    EXPECT_EQ(state.field.storedBricks(), 0U);
    if (state.smoothing) {
      EXPECT_EQ(state.smoothing->result().storedBricks(), 0U);
    }
    expectSame(state, before);
  }
}

// Undo: the bricks that an edit will change are kept, and put back afterwards. All is as it was, storage included.
TEST_P(EveryField, PutsBricksBack) {
  Volume volume = ball({53, 41, 37}, 12);
  gpu::Gpu gpu({});
  State state(gpu, volume, false, 0, true, chain_, way_);
  State before(gpu, volume, false, 0, true, chain_, way_);
  Editor editor(state.parts(gpu), profileOf(volume), false);
  RandomEdits random(volume.size(), volume.lattice(), -120, 220, 21);
  std::vector<std::vector<BrickContent>> kept;
  for (int n = 0; n < 40; ++n) {
    const std::vector<EditCommand> commands = {random.next(), random.next()};
    kept.emplace_back();
    for (const std::uint32_t brick : editor.bricksToChange(commands)) kept.back().push_back(editor.content(brick));
    EXPECT_EQ(editor.apply(commands, nullptr).changed_bricks, kept.back().size());
    editor.settle();
  }
  for (; !kept.empty(); kept.pop_back()) {
    editor.replace(kept.back(), nullptr);
    editor.settle();
  }
  EXPECT_EQ(editor.version(), 80U);
  expectSame(state, before);
  EXPECT_GT(editor.changedBricks(), 10U);
  EXPECT_EQ(editor.readBack(volume), 0U);  // every one of them holds what it held
  State after(gpu, volume, false, 0, true, chain_, way_);
  expectSame(after, before);
}

TEST(Editor, RefusesBricksThatAreNone) {
  Volume volume = ball({40, 40, 40}, 12);
  gpu::Gpu gpu({});
  State state(gpu, volume, false);
  Editor editor(state.parts(gpu), profileOf(volume), false);
  const std::vector<float> one = {5};
  const std::vector<float> few(17, 5.0F);
  const std::vector<float> nan = {std::numeric_limits<float>::quiet_NaN()};
  using Bricks = std::vector<BrickContent>;
  for (const Bricks& bricks : {Bricks{{125, one}}, Bricks{{3, one}, {3, one}}, Bricks{{3, few}}, Bricks{{3, nan}}})
    EXPECT_THROW(editor.replace(bricks, nullptr), Error);
  EXPECT_EQ(editor.version(), 0U);
}

// The volume fills its first slab of 65536 bricks but for a few: edits begin a second one, and every kernel that reads
// the pool is built anew for several.
TEST_P(EveryField, CrossesIntoASecondSlab) {
  if (*chain_ != '\0') return;  // the other two do
  const Vec3i size(512, 512, 136);
  int stored = 0;
  Volume volume = Volume::fromBricks(size, lattice(), {}, [&](const Vec3i& brick, float* values) {
    std::fill_n(values, kBrickVoxels, -100.0F);
    if (brick.z() > 0 && stored < 65530) {
      values[stored % kBrickVoxels] = -99.0F;  // one voxel: stored, and far below the isovalue
      ++stored;
    }
    return false;
  });
  ASSERT_EQ(volume.storedBricks(), 65530U);
  gpu::Gpu gpu({});
  State state(gpu, volume, false, 0, true, chain_, way_);
  EXPECT_EQ(state.pool.slabCount(), 1U);
  Editor editor(state.parts(gpu), profileOf(volume), false);
  std::vector<EditCommand> commands;
  for (const double i : {40.0, 200.0, 500.0}) commands.push_back(brush(EditKind::kAdd, volume, {i, 300, 6}, 9e-3));
  commands.push_back(brush(EditKind::kSmooth, volume, {200, 300, 9}, 9e-3));
  commands.push_back(brush(EditKind::kRemove, volume, {42, 302, 7}, 5e-3));
  for (const EditCommand& command : commands) {
    editor.apply(std::span(&command, 1), nullptr);
    editor.settle();
  }
  EXPECT_EQ(state.pool.slabCount(), 2U);
  // More bricks than one binding holds are refused, before anything changes.
  std::vector<BrickContent> many;
  for (std::uint32_t b = 0; b <= 65536; ++b) many.push_back({b, std::vector<float>(kBrickVoxels, 1.0F)});
  EXPECT_THROW(editor.replace(many, nullptr), Error);
  many.clear();
  editor.readBack(volume);
  State fresh(gpu, volume, false, 0, true, chain_, way_);
  expectSame(state, fresh);
}

// 1024^3 voxels that are constant but for what edits store: 2^21 bricks cost a page and bounds of 8 bytes each on the
// GPU, and no edit makes that more than by what it stores. (2048^3 is the same with eight times the pages.)
TEST(Editor, KeepsASparseVolumeSparse) {
  const Vec3i size = Vec3i::Constant(1024);
  Volume volume = Volume::fromBricks(size, lattice(), {}, [](const Vec3i& brick, float* values) {
    values[0] = brick.z() < 64 && brick.x() > 60 ? 200.0F : -100.0F;
    return true;
  });
  gpu::Gpu gpu({});
  State state(gpu, volume, false);
  Editor editor(state.parts(gpu), profileOf(volume), false);
  const std::uint64_t before = gpu.bytesInUse();
  const std::uint64_t samples = state.store.bytes();
  constexpr std::uint64_t kMiB = std::uint64_t{1} << 20U;
  EXPECT_LE(before - samples, 2 * (std::uint64_t{1} << 24U) + 8 * kMiB);
  for (const double i : {480.0, 500.0, 900.0}) {
    EditCommand command = brush(EditKind::kRemove, volume, {i, 500, 505}, 12e-3);
    command.to_W = volume.lattice().toWorld({i + 30, 520, 490});
    EXPECT_LT(editor.apply(std::span(&command, 1), nullptr).changed_bricks, 1000U);
    editor.settle();
  }
  EXPECT_LE(gpu.bytesInUse(), before + state.store.bytes() - samples + 8 * kMiB);
  EXPECT_GT(editor.readBack(volume), 100U);
  EXPECT_EQ(volume.storedBricks(), state.pool.storedBricks());
}

}  // namespace
}  // namespace palpate
