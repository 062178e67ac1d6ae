// SPDX-License-Identifier: Apache-2.0
// How many bricks one edit may change. What edits do is tested with the editor (tests/engine/service).
#include "engine/passes/edit_pass.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "test_fields.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace edit_pass_test {

constexpr const char* kTooMany =
    "edit: it changes 65537 bricks at once and 65536 are the most; nothing was changed; "
    "use a smaller brush, or several edits";

class EditLimits : public testing::Test {
 protected:
  static EditPhase phaseOf(layout::uint kind, std::size_t bricks) {
    EditPhase phase;
    phase.kind = kind;
    phase.tasks.resize(bricks);
    return phase;
  }
  std::string refusal(std::vector<EditPhase> phases, std::size_t more_tasks = 0) {
    return refusalOf([&] { pass_.fit(phases, {}, more_tasks); }, Error::Code::kOutOfMemory);
  }

  gpu::Gpu gpu_{{}};
  gpu::Transfer transfer_{gpu_};
  BrickPool pool_{gpu_, transfer_, ballField({20, 20, 20}, 6)};
  EditPass pass_{gpu_, pool_};
};

// What a stencil computes is kept aside, in one binding; other kinds change bricks where they are.
TEST_F(EditLimits, AStencilTakesWhatOneBindingHolds) {
  static_assert(BRICKS_PER_DENSITY_SLAB == 65536);
  for (const layout::uint kind : {EDIT_SMOOTH, EDIT_INFLATE, EDIT_DEFLATE}) {
    EXPECT_EQ(refusal({phaseOf(EDIT_ADD, 1), phaseOf(kind, 65537), phaseOf(kind, 2)}), kTooMany) << kind;
  }
  EXPECT_EQ(refusal({phaseOf(EDIT_ADD, 65537), phaseOf(EDIT_SMOOTH, 65536)}), kNoRefusal);
}

TEST_F(EditLimits, AllTasksLieInOneBinding) {
  constexpr std::size_t kMost = (std::size_t{128} << 20U) / sizeof(layout::EditTask);
  const std::string words = refusal({phaseOf(EDIT_ADD, 3), phaseOf(EDIT_CUT, 2)}, kMost - 4);
  EXPECT_EQ(words, fmt::format("edit: it changes {} bricks at once and {} are the most; nothing was changed; "
                               "use a smaller brush, or several edits",
                               kMost + 1, kMost));
}

TEST_F(EditLimits, GivenBricksLieInOneBinding) {
  EXPECT_EQ(refusalOf([&] { pass_.fitGiven(65537); }, Error::Code::kOutOfMemory), kTooMany);
}

// For each phase one for each slab, and one more.
TEST_F(EditLimits, DispatchesAreCounted) {
  ASSERT_EQ(pool_.slabCount(), 1U);
  EXPECT_EQ(pass_.dispatches(std::vector<EditPhase>(3)), 6U);
}

}  // namespace edit_pass_test
}  // namespace palpate
