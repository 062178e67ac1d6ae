// SPDX-License-Identifier: Apache-2.0
#include "apps/report/label_placer.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace {

bool overlap(const LabelBox& a, const LabelBox& b) {
  return a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
}

TEST(LabelPlacer, GoesToTheRightWhereNothingIsInTheWay) {
  LabelPlacer placer(200, 100);
  const LabelBox box = placer.place({50, 50}, 10, 40, 14);
  EXPECT_EQ(box.left, 60);
  EXPECT_EQ(box.right, 100);
  EXPECT_EQ(box.top, 43);
  EXPECT_EQ(box.bottom, 57);
}

// Two marks at one place, and a third beside them: their words stay apart.
TEST(LabelPlacer, WordsStayApart) {
  LabelPlacer placer(300, 200);
  const LabelBox a = placer.place({100, 100}, 10, 60, 14);
  const LabelBox b = placer.place({100, 100}, 10, 60, 14);
  const LabelBox c = placer.place({110, 103}, 10, 60, 14);
  EXPECT_FALSE(overlap(a, b));
  EXPECT_FALSE(overlap(a, c));
  EXPECT_FALSE(overlap(b, c));
}

TEST(LabelPlacer, StaysInsideThePicture) {
  LabelPlacer placer(200, 100);
  for (const Pixel& at : {Pixel{199, 50}, Pixel{1, 99}, Pixel{199, 1}, Pixel{100, 99}}) {
    const LabelBox box = placer.place(at, 10, 40, 14);
    EXPECT_GE(box.left, 0);
    EXPECT_GE(box.top, 0);
    EXPECT_LE(box.right, 200);
    EXPECT_LE(box.bottom, 100);
  }
}

// A path that leaves the mark to the right, and one to the left: the words go below.
TEST(LabelPlacer, DoesNotCrossALineIfItCanHelpIt) {
  LabelPlacer placer(400, 200);
  placer.avoidLine({{100, 100}, {300, 100}});
  EXPECT_LT(placer.place({100, 100}, 10, 40, 14).right, 100);
  LabelPlacer both(400, 200);
  both.avoidLine({{20, 100}, {300, 100}});
  EXPECT_GT(both.place({100, 100}, 10, 40, 14).top, 100);
}

// Marks all around: a short piece of a line is crossed rather than going where the words would seem to be another's.
TEST(LabelPlacer, StaysNearItsMarkRatherThanClearOfAPieceOfLine) {
  LabelPlacer placer(200, 200);
  placer.avoidLine({{112, 100}, {124, 100}});
  placer.avoid({0, 0, 95, 200});      // left of the mark
  placer.avoid({95, 0, 150, 88});     // above
  placer.avoid({95, 112, 150, 200});  // and below
  const LabelBox box = placer.place({100, 100}, 8, 30, 10);
  EXPECT_EQ(box.left, 108);
  EXPECT_EQ(box.top, 95);
}

// Between words and a line, the line is the smaller evil.
TEST(LabelPlacer, CoversALineRatherThanWords) {
  LabelPlacer placer(60, 40);
  placer.avoidLine({{30, 0}, {30, 40}});
  placer.avoid({0, 0, 60, 20});
  const LabelBox box = placer.place({30, 20}, 2, 40, 14);
  EXPECT_GE(box.top, 20);
  EXPECT_LE(box.bottom, 40);
}

}  // namespace
}  // namespace palpate
