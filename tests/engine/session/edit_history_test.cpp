// SPDX-License-Identifier: Apache-2.0
// The history's memory, and undo and redo of more bricks than the engine takes at once.
#include "engine/session/edit_history.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <malloc.h>

#include "base/error.hpp"
#include "engine/journal/volume_identity.hpp"
#include "failing_memory.hpp"

namespace palpate {
namespace edit_history_test {

Lattice millimetres() {
  Lattice lattice;
  lattice.spacing_m = Vec3::Constant(1e-3);
  return lattice;
}

// 69632 bricks of one density each, of which the engine takes 65536 at once.
Volume large() {
  return Volume::fromBricks({512, 512, 136}, millimetres(), {}, [](const Vec3i&, float* values) {
    values[0] = 100;
    return true;
  });
}

struct Edited {
  Volume volume;
  Engine engine;
  EditHistory history;

  Edited(Volume of, std::size_t budget_bytes, std::uint64_t gpu_memory_bytes = 0)
      : volume(std::move(of)), engine(volume, makePlan({}), 30, "", gpu_memory_bytes), history(engine, budget_bytes) {
    engine.allowEdits(brushProfile(30, -100, 100, Vec3::Constant(1e-3)));
  }
  std::uint64_t hash() {
    engine.readBack(volume);
    return contentHash(volume);
  }
};

EditCommand cutAt(double x_m) {
  EditCommand cut;
  cut.kind = EditKind::kCut;
  cut.plane_W = Vec3(x_m, 0, 0);
  cut.normal_W = Vec3::UnitX();
  return cut;
}

EditCommand dab(const Vec3& at_m, EditKind kind = EditKind::kRemove) {
  EditCommand command;
  command.kind = kind;
  command.from_W = command.to_W = at_m;
  command.radius_m = 6e-3;
  return command;
}

// A copy of a constant brick takes what a constant brick needs, not what a stored one does.
TEST(EditHistory, BricksOfOneDensityTakeLittle) {
  Edited edited(large(), std::size_t{1} << 30U);
  const BrickContent content = edited.engine.content(3);
  EXPECT_EQ(content.values.size(), 1U);
  EXPECT_EQ(content.values.capacity(), 1U);
  const EditCommand cut = cutAt(100.5e-3);
  edited.history.edit({&cut, 1}, 0);
  const std::size_t bricks = edited.engine.changedBricks();
  EXPECT_GT(bricks, 50'000U);
  EXPECT_LE(edited.history.bytes(), bricks * 64 + 32);
  EXPECT_GE(edited.history.bytes(), bricks * (sizeof(BrickContent) + 32));  // the heap gives no less for a vector
}

// A stored brick's copy is 2 KiB and a vector. A block of the heap has at least 8 bytes beside what it holds, and no
// more than 16. What an undo leaves to redo are eight constant bricks.
TEST(EditHistory, StoredBricksTakeTwoKibibytesEach) {
  std::vector<float> values(4096);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i % 97);
  Edited edited(Volume::fromDense({16, 16, 16}, millimetres(), values, {}), std::size_t{1} << 20U);
  EditCommand all = dab(Vec3::Constant(7.5e-3));
  all.radius_m = 25e-3;
  edited.history.edit({&all, 1}, 0);
  constexpr std::size_t kStep = sizeof(std::vector<BrickContent>) + sizeof(std::size_t);
  EXPECT_GE(edited.history.bytes(), kStep + 8 * (sizeof(BrickContent) + 2048 + 8));
  EXPECT_LE(edited.history.bytes(), kStep + 8 * (sizeof(BrickContent) + 2048 + 16));
  edited.history.undo(0);
  EXPECT_EQ(edited.history.bytes(), kStep + 8 * (sizeof(BrickContent) + 32));
}

// A cut of 50,000 bricks needs 3 MiB; a budget of 1 MiB is not asked for them, and nothing is copied.
TEST(EditHistory, AnEditBeyondTheBudgetForgetsAllAndIsNotCopied) {
  Edited edited(large(), std::size_t{1} << 20U);
  const EditCommand small = dab({0.2, 0.2, 0.06});
  for (int i = 0; i < 2; ++i) edited.history.edit({&small, 1}, 0);
  EXPECT_EQ(edited.history.steps(), 2U);
  const EditCommand cut = cutAt(100.5e-3);
  const std::size_t copies_before = failing_memory::single_floats;
  edited.history.edit({&cut, 1}, 0);
  EXPECT_LT(failing_memory::single_floats - copies_before,
            10'000U);  // of 50,000; planning makes some lists of one number, too
  EXPECT_EQ(edited.history.steps(), 0U);
  EXPECT_EQ(edited.history.bytes(), 0U);
  EXPECT_EQ(edited.history.forgotten(), 3U);
  EXPECT_EQ(edited.engine.editVersion(), 3U);
  EXPECT_FALSE(edited.history.canUndo());
  EXPECT_FALSE(edited.history.canRedo());
}

// An undone edit's copies are of what it made, which is stored where constant bricks were before.
TEST(EditHistory, KeepsToTheBudgetWhenUndoTakesMoreThanTheEdit) {
  Edited edited(large(), 40'000);
  for (int i = 0; i < 4; ++i) {
    const EditCommand hole = dab({0.05 + 0.05 * i, 0.2, 0.06});
    edited.history.edit({&hole, 1}, 0);
  }
  EXPECT_EQ(edited.history.steps(), 4U);
  const std::uint64_t last = edited.hash();
  edited.history.undo(0);
  EXPECT_LE(edited.history.bytes(), 40'000U);
  if (edited.history.canRedo()) {
    edited.history.redo(0);
    EXPECT_EQ(edited.hash(), last);
  }
  while (edited.history.canUndo()) {
    edited.history.undo(0);
    EXPECT_LE(edited.history.bytes(), 40'000U);
  }
}

// Two holes in bricks of one density: a step takes much more once it is undone, since it then holds what the edit made.
// Too much by a byte, the oldest edit goes, though it is in effect; with none in effect, the newest of those undone.
TEST(EditHistory, BeyondTheBudgetTheOldestEditGoesAndThenTheNewestUndone) {
  const auto volume = [] {
    return Volume::fromBricks({64, 32, 32}, millimetres(), {}, [](const Vec3i&, float* values) {
      values[0] = 100;
      return true;
    });
  };
  const auto hole = [](Edited& edited, double x_m) {
    const EditCommand command = dab({x_m, 12e-3, 12e-3});
    edited.history.edit({&command, 1}, 0);
  };
  Edited measured(volume(), std::size_t{1} << 20U);
  hole(measured, 12e-3);
  const std::size_t done = measured.history.bytes();
  const std::uint64_t one_hole = measured.hash();
  measured.history.undo(0);
  const std::size_t undone = measured.history.bytes();
  ASSERT_GT(undone, 4 * done);
  for (const std::size_t short_of : {0, 1}) {
    Edited edited(volume(), done + undone - short_of);
    hole(edited, 12e-3);
    hole(edited, 44e-3);
    const std::uint64_t two_holes = edited.hash();
    edited.history.undo(0);
    EXPECT_EQ(edited.hash(), one_hole);
    EXPECT_EQ(edited.history.canUndo(), short_of == 0);
    EXPECT_EQ(edited.history.forgotten(), short_of);
    if (edited.history.canUndo()) edited.history.undo(0);
    EXPECT_EQ(edited.history.steps(), 1U);
    EXPECT_EQ(edited.history.bytes(), undone);
    EXPECT_EQ(edited.history.forgotten(), short_of);
    edited.history.redo(0);
    EXPECT_EQ(edited.hash(), short_of == 0 ? one_hole : two_holes);
    EXPECT_FALSE(edited.history.canRedo());
  }
}

// A stroke of dabs over the same bricks takes the memory of one, and is forgotten as a whole.
TEST(EditHistory, JoinedEditsShareTheirCopies) {
  const auto volume = [] {
    std::vector<float> values(32768);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i % 97);
    return Volume::fromDense({32, 32, 32}, millimetres(), values, {});
  };
  const EditCommand small = dab({8e-3, 8e-3, 8e-3}), other = dab({24e-3, 24e-3, 24e-3});
  Edited edited(volume(), std::size_t{1} << 20U);
  edited.history.edit({&small, 1}, 0, UndoStep::kLast);  // there is nothing to join
  const std::size_t bytes = edited.history.bytes();
  const std::uint64_t first = edited.hash();
  for (int i = 0; i < 5; ++i) edited.history.edit({&small, 1}, 0, UndoStep::kLast);
  EXPECT_EQ(edited.history.bytes(), bytes);
  EXPECT_EQ(edited.history.editsToUndo(), 6U);
  edited.history.edit({&other, 1}, 0, UndoStep::kLast);
  EXPECT_GT(edited.history.bytes(), bytes);
  EXPECT_EQ(edited.history.steps(), 1U);
  edited.history.undo(0);
  EXPECT_EQ(edited.history.editsToUndo(), 0U);
  EXPECT_EQ(edited.history.editsToRedo(), 7U);
  edited.history.edit({&small, 1}, 0, UndoStep::kLast);  // the last step was undone
  EXPECT_EQ(edited.history.editsToUndo(), 1U);
  EXPECT_EQ(edited.hash(), first);

  Edited scarce(volume(), bytes);
  scarce.history.edit({&small, 1}, 0);
  for (int i = 0; i < 2; ++i) scarce.history.edit({&small, 1}, 0, UndoStep::kLast);
  EXPECT_EQ(scarce.history.editsToUndo(), 3U);
  scarce.history.edit({&other, 1}, 0, UndoStep::kLast);  // for which there is no room
  EXPECT_FALSE(scarce.history.canUndo());
  EXPECT_EQ(scarce.history.forgotten(), 4U);
  EXPECT_EQ(scarce.history.bytes(), 0U);
}

// Neither budget counts an edit that the engine refuses.
TEST(EditHistory, ARefusedEditIsNotForgotten) {
  for (const std::size_t budget : {0, 10, 1'000'000}) {
    Edited edited(Volume::fromDense({8, 8, 8}, millimetres(), std::vector<float>(512, 100.0F), {}), budget);
    EditCommand bad = dab({4e-3, 4e-3, 4e-3});
    bad.strength = 2;
    EXPECT_THROW(edited.history.edit({&bad, 1}, 0), Error);
    EXPECT_EQ(edited.history.forgotten(), 0U) << budget;
  }
}

EditCommand paintAll() {
  EditCommand paint = dab({0.256, 0.256, 0.068}, EditKind::kPaint);
  paint.radius_m = 0.5;
  paint.value = 150;
  return paint;
}

TEST(EditHistory, UndoesAndRedoesMoreBricksThanTheEngineTakesAtOnce) {
  Edited edited(large(), std::size_t{1} << 30U);
  const std::uint64_t before = edited.hash();
  const EditCommand paint = paintAll();
  EXPECT_EQ(edited.history.edit({&paint, 1}, 0).changed_bricks, 69632U);
  const std::uint64_t after = edited.hash();
  EXPECT_NE(before, after);
  edited.history.undo(0);
  EXPECT_EQ(edited.hash(), before);
  edited.history.redo(0);
  EXPECT_EQ(edited.hash(), after);
}

// Memory fails somewhere in the second part, of 4096 bricks: the first part is put back.
TEST(EditHistory, AnUndoInPartsIsAllOrNothing) {
  Edited edited(large(), std::size_t{1} << 30U);
  const EditCommand paint = paintAll();
  edited.history.edit({&paint, 1}, 0);
  const std::uint64_t after = edited.hash();
  const std::size_t bytes = edited.history.bytes();
  const std::size_t before_undo = failing_memory::allocations;
  edited.history.undo(0);
  const std::size_t in_undo = failing_memory::allocations - before_undo;
  edited.history.redo(0);
  ASSERT_EQ(edited.hash(), after);
  ASSERT_EQ(edited.history.bytes(), bytes);  // of the same copies again
  bool in_second_part = false;
  for (std::size_t from_end = 8000; from_end > 0 && !in_second_part; from_end -= 500) {
    const std::uint64_t version = edited.engine.editVersion();
    failing_memory::failAfter(in_undo - from_end);
    EXPECT_THROW(edited.history.undo(0), std::bad_alloc);
    failing_memory::failNoMore();
    ASSERT_FALSE(edited.engine.broken());
    ASSERT_EQ(edited.hash(), after) << from_end;
    ASSERT_EQ(edited.history.bytes(), bytes);
    ASSERT_TRUE(edited.history.canUndo());
    in_second_part = edited.engine.editVersion() == version + 2;  // a part, and back again
  }
  EXPECT_TRUE(in_second_part);
}

}  // namespace edit_history_test
}  // namespace palpate
