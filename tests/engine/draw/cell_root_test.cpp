// SPDX-License-Identifier: Apache-2.0
// Where a ray first meets the isosurface in a cell (shaders/draw_cell.math.glsl), against thousands of small steps in
// double along the same way.
#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "shaders/kernel_text.hpp"

namespace palpate {
namespace cell_root_test {

using kernel_text::vec3;
using Corners = std::array<double, 8>;

double trilinear(const Corners& c, double x, double y, double z) {
  double sum = 0;
  for (unsigned i = 0; i < 8; ++i)
    sum += c[i] * ((i & 1) != 0 ? x : 1 - x) * ((i & 2) != 0 ? y : 1 - y) * ((i & 4) != 0 ? z : 1 - z);
  return sum;
}

double along(const Corners& c, const vec3& a, const vec3& b, double u) {
  const auto at = [u](float from, float to) { return from + u * (static_cast<double>(to) - from); };
  return trilinear(c, at(a.x, b.x), at(a.y, b.y), at(a.z, b.z));
}

float found(const Corners& corners, double isovalue, const vec3& from, const vec3& to) {
  float c[8];
  for (std::size_t i = 0; i < 8; ++i) c[i] = static_cast<float>(corners[i]);
  kernel_text::scaleCorners(c, static_cast<float>(isovalue));
  const kernel_text::CellInterval within = kernel_text::firstInterval(c, from, to);
  return within.at_high > 0 ? kernel_text::rootIn(within, c, from, to) : -1;
}

// On two faces of the unit cell, as a ray crosses it.
vec3 onFace(std::mt19937& random) {
  std::uniform_real_distribution<float> unit(0, 1);
  std::array<float, 3> p = {unit(random), unit(random), unit(random)};
  p[random() % 3] = random() % 2 == 0 ? 0.0F : 1.0F;
  return {p[0], p[1], p[2]};
}

TEST(CellRoot, IsWhereSmallStepsFindTheFirstPointInside) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> density(-1, 1);
  constexpr int kSteps = 2000;
  constexpr double kRest = 2e-3;  // what eight steps of the search may leave (draw.layout.h)
  int hits = 0, misses = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    Corners corners{};
    // Densities of all sizes, among them values equal to the isovalue.
    const double scale = std::pow(10.0, static_cast<double>(random() % 61) - 30);
    for (double& c : corners) c = random() % 8 == 0 ? 0 : static_cast<float>(scale * density(random));
    const vec3 from = onFace(random), to = onFace(random);
    double largest = 0;
    for (const double c : corners) largest = std::max(largest, std::fabs(c));
    if (largest == 0) continue;
    // Floats of densities up to `largest` are off by some 1e-6 of it: a dozen roundings of 6e-8.
    const double blur = 1e-6 * largest;
    const float u = found(corners, 0, from, to);
    double first = 2, surely = 2;  // the first step inside, and the first that is so beyond the blur
    for (int i = 0; i <= kSteps && surely > 1; ++i) {
      const double at = static_cast<double>(i) / kSteps;
      const double value = along(corners, from, to, at);
      if (value > -blur && first > 1) first = at;
      if (value > blur) surely = at;
    }
    if (u < 0) {
      EXPECT_GT(surely, 1) << trial;
      ++misses;
      continue;
    }
    ++hits;
    ASSERT_LE(u, 1);
    // Not before the surface: on the way there no step is inside, nor the point itself deep in it.
    EXPECT_LE(u, surely + kRest) << trial;
    EXPECT_GE(u, std::min(first, surely) - 1.0 / kSteps - kRest) << trial;
  }
  EXPECT_GT(hits, 5000);
  EXPECT_GT(misses, 3000);
}

// Along x from -1 to 3 the density is a line: the isovalue 0 is a quarter of the way in, 2 three quarters.
TEST(CellRoot, OfALineIsExact) {
  const Corners corners = {-1, 3, -1, 3, -1, 3, -1, 3};
  const vec3 from{0, 0.5F, 0.5F}, to{1, 0.5F, 0.5F};
  EXPECT_FLOAT_EQ(found(corners, 0, from, to), 0.25F);
  EXPECT_FLOAT_EQ(found(corners, 2, from, to), 0.75F);
  EXPECT_EQ(found(corners, 3, from, to), -1.0F);    // it only gets there
  EXPECT_EQ(found(corners, -1.5, from, to), 0.0F);  // it begins inside
  EXPECT_EQ(found(corners, -1, from, to), 0.0F);    // and rises from there
}

// 4 x (1 - x) - 1 along the cell's diagonal of a face: it rises above 0 and falls below it within the cell. With
// corners a at two ends and b beside them the density is a ((1-u)^2 + u^2) + 2 b u (1-u).
TEST(CellRoot, OfAHumpIsItsFirstSide) {
  const Corners corners = {-1, 1, 1, -1, -1, 1, 1, -1};  // a = -1, b = 1: -1 + 4 u (1 - u), whose roots are both 1/2
  const vec3 from{0, 0, 0.5F}, to{1, 1, 0.5F};
  EXPECT_EQ(found(corners, 0, from, to), -1.0F);  // touches it and is never above
  // -1 + 4 u (1-u) = -0.5 at u = (1 - sqrt(1/2)) / 2
  EXPECT_NEAR(found(corners, -0.5, from, to), (1 - std::sqrt(0.5)) / 2, 1e-5);
}

// The largest floats of both signs, and denormals.
TEST(CellRoot, HoldsAtTheEndsOfTheFloats) {
  const vec3 from{0, 0.5F, 0.5F}, to{1, 0.5F, 0.5F};
  for (const double big : {3e38, 1e-39, 4e-45}) {
    const Corners corners = {-big, big, -big, big, -big, big, -big, big};
    EXPECT_NEAR(found(corners, 0, from, to), 0.5F, 1e-6) << big;
  }
}

// At a face only its own corners count, even where the others are far larger.
TEST(CellRoot, AFaceOfObjectIsNotMissed) {
  const float tiny = 1e-12F;
  const Corners corners = {-1, tiny, -1, tiny, -1, tiny, -1, tiny};
  EXPECT_NEAR(found(corners, 0, {0, 0.3F, 0.7F}, {1, 0.6F, 0.1F}), 1.0F, 1e-6);
}

}  // namespace cell_root_test
}  // namespace palpate
