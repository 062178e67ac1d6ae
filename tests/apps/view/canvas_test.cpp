// SPDX-License-Identifier: Apache-2.0
// Shapes whose edges lie on edges of pixels, so that every pixel is known.
#include "apps/view/canvas.hpp"

#include <functional>

#include <gtest/gtest.h>

#include "decoded.hpp"

namespace palpate {
namespace canvas_test {

constexpr Color kRed = {1, 0, 0}, kBlue = {0, 0, 1}, kWhite = {1, 1, 1}, kBlack = {0, 0, 0};

// Every pixel is white or, where `inside` says so, of the colour.
void expectOnly(Canvas& canvas, const Color& color, const std::function<bool(int, int)>& inside) {
  const Decoded image = decode(canvas.png());
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      EXPECT_TRUE(hasColor(image, x, y, inside(x, y) ? color : kWhite)) << x << ' ' << y;
    }
  }
}

TEST(Canvas, FillsARectangle) {
  const std::unique_ptr<Canvas> picture = makeCanvas(9, 7);
  Canvas& canvas = *picture;
  canvas.fillRectangle(2, 1, 4, 3, kRed);
  expectOnly(canvas, kRed, [](int x, int y) { return x >= 2 && x < 6 && y >= 1 && y < 4; });
}

// From 2 to 8 and from 1 to 5, but for its corners. A dashed line before it leaves no dashes behind.
TEST(Canvas, DrawsAFrame) {
  const std::unique_ptr<Canvas> picture = makeCanvas(9, 7);
  Canvas& canvas = *picture;
  canvas.polyline({{0, 0}, {1, 0}}, kWhite, 1, 2);
  canvas.strokeRectangle(2.5, 1.5, 5, 3, kBlue, 1);
  const Decoded image = decode(canvas.png());
  EXPECT_EQ(countColor(image, 3, 1, 7, 2, kBlue) + countColor(image, 3, 4, 7, 5, kBlue), 4 + 4);
  EXPECT_EQ(countColor(image, 2, 2, 3, 4, kBlue) + countColor(image, 7, 2, 8, 4, kBlue), 2 + 2);
  EXPECT_EQ(countColor(image, 3, 2, 7, 4, kWhite), 4 * 2);
  EXPECT_EQ(countColor(image, 0, 0, 9, 7, kWhite), 9 * 7 - 6 * 4 + 4 * 2);
}

TEST(Canvas, CopiesAPicture) {
  const std::unique_ptr<Canvas> picture = makeCanvas(5, 4);
  Canvas& canvas = *picture;
  canvas.image({2, 2, {10, 20, 30, 0, 40, 50, 60, 0, 70, 80, 90, 0, 1, 2, 3, 0}, {}}, 1, 2);
  const Decoded image = decode(canvas.png());
  EXPECT_EQ(image.at(1, 2), 0x0A141EU);
  EXPECT_EQ(image.at(2, 2), 0x28323CU);
  EXPECT_EQ(image.at(1, 3), 0x46505AU);
  EXPECT_EQ(image.at(2, 3), 0x010203U);
  EXPECT_EQ(countColor(image, 0, 0, 5, 4, kWhite), 16);
}

TEST(Canvas, ClipsToARectangleWhoseCornerIsTheOrigin) {
  const std::unique_ptr<Canvas> picture = makeCanvas(9, 7);
  Canvas& canvas = *picture;
  canvas.pushClip(3, 2, 4, 3);
  canvas.fillRectangle(1, -5, 90, 90, kRed);
  canvas.popClip();
  canvas.fillRectangle(0, 0, 1, 1, kRed);
  expectOnly(canvas, kRed, [](int x, int y) { return (x >= 4 && x < 7 && y >= 2 && y < 5) || (x == 0 && y == 0); });
}

// Dashes of 5 and gaps of 4, with straight ends; a line without dashes has round ends.
TEST(Canvas, DrawsDashes) {
  const std::unique_ptr<Canvas> picture = makeCanvas(24, 5);
  Canvas& canvas = *picture;
  canvas.polyline({{1, 2.5}, {22, 2.5}}, kRed, 1, 5);
  canvas.polyline({{4, 1}}, kRed, 1);
  expectOnly(canvas, kRed,
             [](int x, int y) { return y == 2 && ((x >= 1 && x < 6) || (x >= 10 && x < 15) || (x >= 19 && x < 22)); });
}

TEST(Canvas, LinesHaveRoundEndsAndCorners) {
  const std::unique_ptr<Canvas> picture = makeCanvas(40, 40);
  Canvas& canvas = *picture;
  canvas.polyline({{10, 10}, {30, 10}, {30, 30}}, kRed, 8);
  const Decoded image = decode(canvas.png());
  EXPECT_TRUE(hasColor(image, 20, 7, kRed));
  EXPECT_TRUE(hasColor(image, 20, 13, kRed) && hasColor(image, 27, 20, kRed));
  EXPECT_TRUE(hasColor(image, 20, 5, kWhite) && hasColor(image, 20, 14, kWhite));
  EXPECT_TRUE(hasColor(image, 7, 9, kRed));     // 3 pixels beyond the end
  EXPECT_TRUE(hasColor(image, 33, 6, kWhite));  // the corner of a square end
}

// 40 long in lines of 2: the head is 9 long and, at its neck, 3.8 to each side.
TEST(Canvas, ArrowsPointFromOneEndToTheOther) {
  for (const bool upright : {false, true}) {
    const std::unique_ptr<Canvas> picture = makeCanvas(56, 56);
    Canvas& canvas = *picture;
    const auto at = [&](double along, double across) { return upright ? Pixel{across, along} : Pixel{along, across}; };
    canvas.arrow(at(5, 20), at(45, 20), kBlue, 2);
    canvas.arrow(at(5, 40), at(5.9, 40), kBlue, 2);  // too short to be drawn
    const Decoded image = decode(canvas.png());
    const auto is = [&](int along, int across, const Color& color) {
      return upright ? hasColor(image, across, along, color) : hasColor(image, along, across, color);
    };
    EXPECT_TRUE(is(20, 19, kBlue) && is(20, 20, kBlue) && is(41, 19, kBlue) && is(41, 20, kBlue)) << upright;
    EXPECT_TRUE(is(20, 18, kWhite) && is(20, 21, kWhite) && is(46, 20, kWhite) && is(2, 20, kWhite)) << upright;
    EXPECT_TRUE(is(37, 17, kBlue) && is(37, 22, kBlue) && is(37, 15, kWhite) && is(37, 24, kWhite)) << upright;
    EXPECT_TRUE(is(34, 17, kWhite) && is(34, 22, kWhite)) << upright;
    EXPECT_TRUE(is(5, 40, kWhite) && is(5, 39, kWhite)) << upright;
  }
}

// Six tenths of a short arrow are head: 12 of 20, where its line would have 18.
TEST(Canvas, AShortArrowKeepsSomeOfItsLine) {
  const std::unique_ptr<Canvas> picture = makeCanvas(40, 40);
  Canvas& canvas = *picture;
  canvas.arrow({5, 20}, {25, 20}, kBlue, 4);
  const Decoded image = decode(canvas.png());
  EXPECT_TRUE(hasColor(image, 14, 16, kBlue) && hasColor(image, 14, 23, kBlue));
  EXPECT_TRUE(hasColor(image, 9, 16, kWhite) && hasColor(image, 9, 20, kBlue));
}

// Radius 16, its rim a quarter of that: from 14 to 18.
TEST(Canvas, DiscsHaveARim) {
  const std::unique_ptr<Canvas> picture = makeCanvas(60, 50);
  Canvas& canvas = *picture;
  canvas.polyline({{0, 0}, {1, 1}}, kWhite, 1);
  canvas.disc({30, 20}, 16, kRed, kBlue);
  const Decoded image = decode(canvas.png());
  for (const int side : {-1, 1}) {
    const auto across = [&](int r) { return 30 + (side > 0 ? r : -1 - r); };
    EXPECT_TRUE(hasColor(image, across(12), 20, kRed) && hasColor(image, across(15), 20, kBlue));
    EXPECT_TRUE(hasColor(image, across(18), 20, kWhite));
  }
  EXPECT_TRUE(hasColor(image, 30, 32, kRed) && hasColor(image, 30, 35, kBlue) && hasColor(image, 30, 38, kWhite));
}

struct Ink {
  int left = 1000, top = 1000, right = -1, bottom = -1;
};
Ink inkOf(const Decoded& image) {
  Ink ink;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      if (image.at(x, y) == 0xFFFFFFU) continue;
      ink = {std::min(ink.left, x), std::min(ink.top, y), std::max(ink.right, x), std::max(ink.bottom, y)};
    }
  }
  return ink;
}

// Capitals stand on the base line and are some 0.73 of the size high, less than a pixel of room on each side of words.
TEST(Canvas, WritesBesideTheGivenPlace) {
  for (const Align align : {Align::kLeft, Align::kCentre, Align::kRight}) {
    const std::unique_ptr<Canvas> picture = makeCanvas(300, 60);
    Canvas& canvas = *picture;
    const double width = canvas.text({150, 40}, "HHHHH", 20, kBlack, align);
    EXPECT_EQ(width, canvas.textWidth("HHHHH", 20));
    const Ink ink = inkOf(decode(canvas.png()));
    const double left = 150 - (align == Align::kLeft ? 0 : align == Align::kCentre ? width / 2 : width);
    EXPECT_NEAR(ink.left, left, 4);
    EXPECT_NEAR(ink.right, left + width, 4);
    EXPECT_NEAR(ink.top, 40 - 0.73 * 20, 2);
    EXPECT_NEAR(ink.bottom, 39, 1);
    EXPECT_GT(canvas.textWidth("HHHHH", 20, true), width);
    EXPECT_NEAR(canvas.textWidth("HHHHH", 40), 2 * width, 0.05 * width);
  }
}

TEST(Canvas, AHaloIsAroundTheWords) {
  for (const bool halo : {false, true}) {
    const std::unique_ptr<Canvas> picture = makeCanvas(100, 60);
    Canvas& canvas = *picture;
    canvas.fillRectangle(0, 0, 100, 60, kRed);
    canvas.text({20, 40}, "HHH", 20, kBlack, Align::kLeft, false, halo);
    const Decoded image = decode(canvas.png());
    const Color light = {1, 0.85, 0.85};  // of white, 85 % over red
    EXPECT_EQ(countColor(image, 0, 0, 100, 60, light) > 100, halo);
    EXPECT_TRUE(hasColor(image, 10, 30, kRed) && hasColor(image, 30, 50, kRed));
  }
}

// What is not UTF-8, or no character that can be shown, is a question mark for each byte.
TEST(Canvas, WritesAQuestionMarkForWhatIsNoCharacter) {
  const std::unique_ptr<Canvas> picture = makeCanvas(10, 10);
  Canvas& canvas = *picture;
  for (const auto& [words, shown] : {std::pair("a\xff", "a?"),
                                     {"\xc3(", "?("},
                                     {"\xe2\x82", "??"},
                                     {"\x80i", "?i"},
                                     {"\xc1\xbf", "??"},
                                     {"\xe0\x80\x80i", "???i"},
                                     {"\xed\xa0\x80i", "???i"},
                                     {"\xf0\x9f\x98\x80", "????"},
                                     {"i\ni", "i?i"},
                                     {"i\x1fi", "i?i"}}) {
    EXPECT_EQ(canvas.textWidth(words, 20), canvas.textWidth(shown, 20)) << shown;
  }
  // An e with an accent is as wide as one without.
  EXPECT_EQ(canvas.textWidth("\xc3\xa9", 20), canvas.textWidth("e", 20));
  EXPECT_NE(canvas.textWidth("\xe2\x82\xac", 20), canvas.textWidth("???", 20));
}

}  // namespace canvas_test
}  // namespace palpate
