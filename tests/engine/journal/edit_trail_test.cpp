// SPDX-License-Identifier: Apache-2.0
// Two states have one name if the same edits lead to them, and only then, whatever was undone in between.
#include "engine/journal/edit_trail.hpp"

#include <map>
#include <random>

#include <gtest/gtest.h>

#include "journal_samples.hpp"

namespace palpate {
namespace edit_trail_test {

JournalHeader header() {
  static const Volume kVolume = sampleVolume();
  return sampleHeader(kVolume);
}

std::vector<EditCommand> numbered(int number) {
  return {dab(number)};
}

EditMark markOf(const std::vector<int>& edits) {
  EditTrail trail(header());
  for (const int edit : edits) trail.edit(numbered(edit), false);
  return *trail.mark();
}

// Against lists of the steps that are done and undone. The names of all states that were met differ by their edits.
TEST(EditTrail, NamesEachStateByTheEditsInEffect) {
  std::mt19937 random(5);
  std::map<std::uint64_t, std::vector<int>> names;
  for (int run = 0; run < 40; ++run) {
    EditTrail trail(header());
    std::vector<std::vector<int>> steps;  // done, then undone
    std::size_t done = 0, undoable = 0;
    int next = 0;
    std::vector<int> forgotten;
    for (int i = 0; i < 80; ++i) {
      switch (std::uniform_int_distribution(0, 7)(random)) {
        case 0:
        case 1:
          if (undoable == 0) continue;
          trail.undo();
          --done;
          --undoable;
          break;
        case 2:
          if (done == steps.size()) continue;
          trail.redo();
          ++done;
          ++undoable;
          break;
        case 3: {
          const std::size_t keep = std::uniform_int_distribution<std::size_t>(0, 12)(random);
          trail.forgetAllBut(keep);
          undoable = std::min(undoable, keep);
          break;
        }
        case 4:
        case 5:
          if (undoable > 0) {
            steps.resize(done);
            steps.back().push_back(++next % 3);
            trail.edit(numbered(next % 3), true);
            break;
          }
          [[fallthrough]];
        default:
          steps.resize(done);
          steps.push_back({++next % 3});
          trail.edit(numbered(next % 3), next % 2 == 0 && undoable == 0);
          ++done;
          ++undoable;
      }
      std::vector<int> edits;
      for (std::size_t s = 0; s < done; ++s) edits.insert(edits.end(), steps[s].begin(), steps[s].end());
      const std::optional<EditMark> mark = trail.mark();
      ASSERT_TRUE(mark) << run << ", " << i;
      ASSERT_EQ(*mark, markOf(edits)) << run << ", " << i;
      ASSERT_EQ(names.try_emplace(mark->hash, edits).first->second, edits) << "two states of one name";
    }
  }
  EXPECT_GT(names.size(), 500U);
}

// As a file that was moved, and not as another one; and what a brush leaves behind depends on the profile.
TEST(EditTrail, BelongsToAVolumeAndAProfile) {
  const EditMark mark = markOf({1, 2});
  JournalHeader moved = header(), other = header(), softer = header();
  moved.volume.source = "/elsewhere";
  other.volume.content ^= 1U;
  softer.profile.slope_per_m *= 2;
  const auto same = [&](const JournalHeader& of) {
    EditTrail trail(of);
    trail.edit(numbered(1), false);
    trail.edit(numbered(2), false);
    return trail.mark() == mark;
  };
  EXPECT_TRUE(same(moved));
  EXPECT_FALSE(same(other));
  EXPECT_FALSE(same(softer));
}

// Another mesh in the same place is another edit, and an equal mesh is the same, from whichever file it came.
TEST(EditTrail, TellsStampsApart) {
  const auto marked = [](std::vector<float> distances) {
    EditCommand command;
    command.kind = EditKind::kStampAdd;
    command.stamp =
        std::make_shared<Stamp>(Stamp{.size = {2, 1, 1}, .lattice = {}, .distance_m = std::move(distances)});
    EditTrail trail(header());
    trail.edit({{command}}, false);
    trail.edit({{command}}, false);
    return *trail.mark();
  };
  EXPECT_EQ(marked({1, 2}), marked({1, 2}));
  EXPECT_NE(marked({1, 2}), marked({1, 3}));
  EXPECT_EQ(marked({1, 2}).edits, 2U);
}

// What it was not told of, it does not name.
TEST(EditTrail, EndsWhereItCannotFollow) {
  EditTrail back(header()), forth(header());
  back.edit(numbered(1), false);
  back.forgetAllBut(0);
  back.undo();
  forth.redo();
  for (EditTrail* trail : {&back, &forth}) {
    EXPECT_FALSE(trail->mark());
    trail->edit(numbered(2), false);
    EXPECT_FALSE(trail->mark());
  }
}

}  // namespace edit_trail_test
}  // namespace palpate
