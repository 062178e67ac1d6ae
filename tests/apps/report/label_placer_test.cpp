// SPDX-License-Identifier: Apache-2.0
#include "apps/report/label_placer.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace palpate {
namespace label_placer_test {

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

// Of 2 pixels on each side, which is what words need, and not of less.
TEST(LabelPlacer, LeavesRoomAroundWords) {
  const auto placed = [](const LabelBox& other) {
    LabelPlacer placer(200, 100);
    placer.avoid(other);
    return placer.place({50, 50}, 10, 40, 14);
  };
  const auto stays = [&](const LabelBox& other) {
    const LabelBox box = placed(other);
    return box.left == 60 && box.top == 43;
  };
  EXPECT_TRUE(stays({102, 0, 200, 100}));  // to the right of the words at 60 to 100, 43 to 57
  EXPECT_FALSE(stays({101.5, 0, 200, 100}));
  EXPECT_TRUE(stays({56, 0, 58, 100}));
  EXPECT_FALSE(stays({56, 0, 58.5, 100}));
  EXPECT_TRUE(stays({0, 0, 200, 41}));
  EXPECT_FALSE(stays({0, 0, 200, 41.5}));
  EXPECT_TRUE(stays({0, 59, 200, 100}));
  EXPECT_FALSE(stays({0, 58.5, 200, 100}));
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

// Beside the mark and moved up or down until 2 pixels are left to the border; no label covers its own mark.
TEST(LabelPlacer, IsMovedIntoThePicture) {
  const auto place = [](const Pixel& at) {
    const LabelBox box = LabelPlacer(200, 100).place(at, 10, 40, 14);
    return std::vector<double>{box.left, box.top, box.right, box.bottom};
  };
  EXPECT_EQ(place({100, 99}), (std::vector<double>{110, 84, 150, 98}));
  EXPECT_EQ(place({1, 1}), (std::vector<double>{11, 2, 51, 16}));
  EXPECT_EQ(place({199, 50}), (std::vector<double>{149, 43, 189, 57}));
}

// A path that leaves the mark to the right, and one to the left: the words go below.
TEST(LabelPlacer, DoesNotCrossALineIfItCanHelpIt) {
  LabelPlacer placer(400, 200);
  placer.avoidLine({{100, 100}, {300, 100}});
  EXPECT_LT(placer.place({100, 100}, 10, 40, 14).right, 100);
  LabelPlacer both(400, 200);
  both.avoidLine({{20, 100}, {300, 100}});
  EXPECT_EQ(both.place({100, 100}, 10, 40, 14).top, 110);
}

// Where both sides are taken: below at the gap, and then above.
TEST(LabelPlacer, StandsAtTheGapBelowAndAbove) {
  LabelPlacer placer(400, 200);
  placer.avoid({0, 0, 92, 200});
  placer.avoid({108, 0, 400, 200});
  const LabelBox below = placer.place({100, 100}, 10, 12, 14);
  EXPECT_EQ(below.left, 94);
  EXPECT_EQ(below.top, 110);
  const LabelBox above = placer.place({100, 100}, 10, 12, 14);
  EXPECT_EQ(above.left, 94);
  EXPECT_EQ(above.bottom, 90);
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

double distance(const LabelBox& box, const Pixel& p) {
  return std::hypot(std::max({box.left - p.x, 0.0, p.x - box.right}), std::max({box.top - p.y, 0.0, p.y - box.bottom}));
}

// "start" and "end" of a path, anywhere in a picture, on a scribble of lines: a word stands nearer to its own mark than
// to the other, whichever was placed first. The sizes are those of panel.cpp at scale 1.
TEST(LabelPlacer, WordsNeverStandAtAnothersMark) {
  std::mt19937 random(11);
  int impossible = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const auto between = [&](double low, double high) {
      return std::uniform_real_distribution<double>(low, high)(random);
    };
    const double width = between(300, 760), height = between(250, 600);
    LabelPlacer placer(width, height);
    for (int line = 0; line < 3; ++line) {
      placer.avoidLine({{between(0, width), between(0, height)}, {between(0, width), between(0, height)}});
    }
    const Pixel start = {between(14, width - 14), between(14, height - 14)};
    const double apart = between(20, 300), turn = between(0, 6.2832);
    const Pixel end = {std::clamp(start.x + apart * std::cos(turn), 14.0, width - 14),
                       std::clamp(start.y + apart * std::sin(turn), 14.0, height - 14)};
    if (std::hypot(end.x - start.x, end.y - start.y) < 20) continue;  // they have one label: panel.cpp
    for (const Pixel& mark : {start, end}) {
      placer.avoid({mark.x - 6, mark.y - 6, mark.x + 6, mark.y + 6});
      placer.addMark(mark);
    }
    const LabelBox first = placer.place(start, 10, 38, 14), second = placer.place(end, 10, 30, 14);
    // Or it says that it cannot, which may be near a border only, and panel.cpp writes one label for both.
    if (placer.isAtAnother(first, start) || placer.isAtAnother(second, end)) {
      const auto fromEdge = [&](const Pixel& p) { return std::min({p.x, p.y, width - p.x, height - p.y}); };
      ASSERT_LT(std::min(fromEdge(start), fromEdge(end)), 40) << "trial " << trial;
      ++impossible;
      continue;
    }
    ASSERT_LT(distance(first, start), distance(first, end)) << "trial " << trial;
    ASSERT_LT(distance(second, end), distance(second, start)) << "trial " << trial;
    ASSERT_FALSE(overlap(first, second)) << "trial " << trial;
    for (const LabelBox& box : {first, second}) {
      ASSERT_TRUE(box.left >= 0 && box.top >= 0 && box.right <= width && box.bottom <= height) << "trial " << trial;
    }
  }
  EXPECT_LT(impossible, 100);
}

}  // namespace label_placer_test
}  // namespace palpate
