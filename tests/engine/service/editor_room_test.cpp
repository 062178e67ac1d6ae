// SPDX-License-Identifier: Apache-2.0
// Edits where memory on the device ends: an error that says which, and everything as it was.
#include <set>

#include "base/error.hpp"
#include "editor_state.hpp"

namespace palpate {
namespace editor_room_test {

class RoomOfEveryField : public EveryField {};
INSTANTIATE_TEST_SUITE_P(Fields, RoomOfEveryField, everyField());

// What the editor says to an edit that has no room.
Error refusalOf(Editor& editor, const std::vector<EditCommand>& commands) {
  try {
    editor.apply(commands, nullptr);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::Code::kOutOfMemory);
    EXPECT_NE(std::string(error.what()).find("nothing was changed"), std::string::npos) << error.what();
    return error;
  }
  ADD_FAILURE() << "it fitted";
  return Error(Error::Code::kBadInput, "", "", "");
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
  {
    const Error error = refusalOf(editor, commands);
    EXPECT_NE(std::string(error.what()).find("--gpu-memory"), std::string::npos) << error.what();
    // What is there, what the edit needs of either kind, the budget; and the sum, rounded up, is enough.
    double used = 0, wanted = 0, densities = 0, samples = 0, limit = 0;
    ASSERT_EQ(std::sscanf(error.reason().c_str(),
                          "the volume, as edited until now, takes %lf MiB, "
                          "the edit needs %lf MiB more (%lf MiB for densities, %lf MiB for samples), "
                          "and the budget is %lf MiB",
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
TEST_P(RoomOfEveryField, IsAsItWasWhicheverPoolHasNoRoom) {
  if (!gradient_operator_.smooths()) return;  // RefusesWhatExceedsTheBudgetAndGoesOn
  const auto volumeOf = [] { return ball({48, 40, 56}, 10); };
  const Volume volume = volumeOf();
  gpu::Gpu gpu({});
  const auto used = [&] {
    State probe(gpu, volume, false, 0, true, chain_, gradient_operator_);
    const Editor editor(probe.parts(gpu), profileOf(volume), false);
    return probe.pool.budget()->used_bytes;
  }();
  const std::vector<EditCommand> large = {brush(EditKind::kSmooth, volume, {24, 20, 28}, 16e-3),
                                          brush(EditKind::kInflate, volume, {24, 20, 28}, 18e-3)};
  const EditCommand small = brush(EditKind::kRemove, volume, {24, 20, 28}, 2e-3);
  std::set<std::string> full;
  int went_on = 0;
  for (std::uint64_t more = 0;; more += std::uint64_t{1} << 19U) {
    State state(gpu, volume, false, used + more, true, chain_, gradient_operator_);
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
    State fresh(gpu, edited, false, 0, true, chain_, gradient_operator_);
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
  const Error error = refusalOf(editor, commands);
  EXPECT_NE(std::string(error.what()).find("smaller brush or stamp"), std::string::npos) << error.what();
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

}  // namespace editor_room_test
}  // namespace palpate
