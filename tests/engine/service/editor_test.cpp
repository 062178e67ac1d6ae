// SPDX-License-Identifier: Apache-2.0
// What an edit changes on the GPU, and what it leaves alone, against formulas and a new start.
#include "engine/service/editor.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <set>

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "editor_state.hpp"
#include "engine/edit/random_edits.hpp"
#include "servo/window/sample_window.hpp"

namespace palpate {
namespace editor_test {

INSTANTIATE_TEST_SUITE_P(Fields, EveryField, everyField());

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

// A history's moment: the bricks still hold what they did, and putting all of that back undoes the edit.
TEST(Editor, TellsTheBricksOfAnEditBeforeTheyChange) {
  Volume volume = ball({53, 41, 37}, 12);
  const std::vector<float> at_first = volume.toDense();
  gpu::Gpu gpu({});
  State state(gpu, volume, false);
  Editor editor(state.parts(gpu), profileOf(volume), false);
  const std::vector<EditCommand> dab = {brush(EditKind::kRemove, volume, {16, 20, 18}, 6e-3)};
  const auto fails = [](std::span<const std::uint32_t>) { throw Error(Error::Code::kCancelled, "x", "y", "z"); };
  EXPECT_THROW(editor.apply(dab, nullptr, fails), Error);
  EXPECT_FALSE(editor.broken());
  EXPECT_EQ(editor.version(), 0U);
  EXPECT_EQ(editor.readBack(volume), 0U);

  int calls = 0;
  std::vector<BrickContent> kept;
  editor.apply(dab, nullptr, [&](std::span<const std::uint32_t> bricks) {
    ++calls;
    EXPECT_TRUE(std::is_sorted(bricks.begin(), bricks.end()));
    for (const std::uint32_t brick : bricks) kept.push_back(editor.content(brick));
  });
  EXPECT_EQ(calls, 1);
  editor.settle();
  EXPECT_GT(editor.readBack(volume), 0U);
  EXPECT_NE(volume.toDense(), at_first);
  editor.replace(kept, nullptr);
  editor.settle();
  editor.readBack(volume);
  EXPECT_EQ(volume.toDense(), at_first);
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
  State state(gpu, volume, false, 0, true, chain_, gradient_operator_);
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
  State state(gpu, volume, false, 0, true, chain_, gradient_operator_);
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
  State state(gpu, volume, false, 0, true, chain_, gradient_operator_);
  State before(gpu, volume, false, 0, true, chain_, gradient_operator_);
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
  State state(gpu, volume, false, 0, true, chain_, gradient_operator_);
  State before(gpu, volume, false, 0, true, chain_, gradient_operator_);
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
  State after(gpu, volume, false, 0, true, chain_, gradient_operator_);
  expectSame(after, before);
}

// In a volume of one density a brick gets a surface, whose first voxel does not tell it; then loses it, and then is
// object. Its surroundings get gradients and give them back as in a new start.
TEST(Editor, ReplacedBricksAreAsInANewStart) {
  Volume volume = Volume::fromBricks({40, 40, 40}, lattice(), {}, [](const Vec3i&, float* values) {
    values[0] = -100;
    return true;
  });
  gpu::Gpu gpu({});
  State state(gpu, volume, false);
  Editor editor(state.parts(gpu), profileOf(volume), false);
  std::vector<float> surface(kBrickVoxels, 200.0F);
  surface[0] = -99;
  const std::uint32_t middle = editor.grid().index({2, 2, 2});
  // Cells that the isosurface crosses begin in bricks 1 to 2 along each axis and end in bricks 1 to 3. Brick (1, 1, 1)
  // sees only the first voxel of the middle one, so with the surface it is left out.
  const std::vector<std::pair<std::vector<float>, std::size_t>> steps = {{surface, 26}, {{-90.0F}, 0}, {{200.0F}, 27}};
  for (const auto& [values, active] : steps) {
    const std::vector<BrickContent> bricks = {{middle, values}};
    editor.replace(bricks, nullptr);
    editor.settle();
    editor.readBack(volume);
    EXPECT_EQ(state.store.brickCount(), active);
    State fresh(gpu, volume, false);
    expectSame(state, fresh);
  }
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
  State state(gpu, volume, false, 0, true, chain_, gradient_operator_);
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
  State fresh(gpu, volume, false, 0, true, chain_, gradient_operator_);
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

}  // namespace editor_test
}  // namespace palpate
