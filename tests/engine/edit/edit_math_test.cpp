// SPDX-License-Identifier: Apache-2.0
// The text of the edit kernels (shaders/edit*.math.glsl), compiled for the CPU, against the twin, which was written
// apart from docs/edits.md: bit for bit. And both against figures by hand, of numbers that floats hold exactly.
#include <algorithm>
#include <array>
#include <bit>
#include <cfloat>
#include <cmath>
#include <functional>
#include <random>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "engine/edit/lower_edit.hpp"
#include "engine/edit/random_edits.hpp"
#include "engine/reference/edited_density.hpp"
#include "shaders/kernel_text.hpp"

namespace palpate {
namespace edit_math_test {

using kernel_text::ivec4;
using kernel_text::vec4;
using layout::EditScale;
using reference::Neighbours;
using Command = layout::EditCommand;

// What the kernels do around the text: the stamp's distances are loaded for each voxel.
vec4 stamped(const Command& c, std::span<const float> stamps, const vec4& px, float py, float pz, const vec4& f) {
  vec4 distance(0);
  kernel_text::bvec4 inside(false);
  for (int i = 0; i < 4; ++i) {
    const kernel_text::StampPlace place = kernel_text::stampPlace(c, px[i], py, pz);
    inside[i] = place.inside;
    if (!place.inside) continue;
    const auto corners = [&](std::size_t first) {
      return vec4(stamps[first], stamps[first + 1], stamps[first + c.stamp_x], stamps[first + c.stamp_x + 1]);
    };
    const std::size_t slice = std::size_t{c.stamp_x} * c.stamp_y;
    distance[i] = kernel_text::stampDistance(place, corners(place.first), corners(place.first + slice));
  }
  return kernel_text::stamped(c.kind, c, distance, inside, f);
}

// Four voxels along i, from `first` on.
vec4 byText(const Command& c, const EditScale& scale, std::span<const float> stamps, const Vec3i& first, const vec4& f,
            const std::array<Neighbours, 4>& around) {
  const ivec4 voxels(first.x(), first.x() + 1, first.x() + 2, first.x() + 3);
  const vec4 px = kernel_text::placesAlong(voxels, c.origin_x, scale.h_x);
  const float py = kernel_text::placeAlong(first.y(), c.origin_y, scale.h_y);
  const float pz = kernel_text::placeAlong(first.z(), c.origin_z, scale.h_z);
  if (c.kind == EDIT_STAMP_ADD || c.kind == EDIT_STAMP_REMOVE) return stamped(c, stamps, px, py, pz, f);
  if (!EDIT_READS_NEIGHBOURS(c.kind)) return kernel_text::edited(c.kind, c, px, py, pz, f);
  const auto before = [&](std::size_t axis) {
    return vec4(around[0].before[axis], around[1].before[axis], around[2].before[axis], around[3].before[axis]);
  };
  const auto after = [&](std::size_t axis) {
    return vec4(around[0].after[axis], around[1].after[axis], around[2].after[axis], around[3].after[axis]);
  };
  const kernel_text::EditNeighbours n{before(0), after(0), before(1), after(1), before(2), after(2)};
  return kernel_text::editedAmong(c.kind, c, scale, px, py, pz, f, n);
}

struct Seen {
  std::array<int, EDIT_KINDS> same{}, changed{};  // voxels, by kind
};

// Compares text and twin at random voxels around the command.
void compare(const Command& c, const EditScale& scale, std::span<const float> stamps, std::mt19937& random,
             const std::function<float()>& density, Seen& seen) {
  for (int n = 0; n < 40; ++n) {
    const unsigned away = n % 2 == 0 ? 4 : 15;  // stamps and most brushes are small
    const auto near = [&](int origin) { return origin + static_cast<int>(random() % (2 * away) - away); };
    const Vec3i first(near(c.origin_x), near(c.origin_y), near(c.origin_z));
    const vec4 f(density(), density(), density(), density());
    std::array<Neighbours, 4> around;
    for (Neighbours& one : around) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        one.before[axis] = density();
        one.after[axis] = density();
      }
    }
    const vec4 text = byText(c, scale, stamps, first, f, around);
    for (int i = 0; i < 4; ++i) {
      const Vec3i voxel = first + Vec3i(i, 0, 0);
      const float twin = reference::editedDensity(c, scale, stamps, voxel, f[i], around[static_cast<std::size_t>(i)]);
      ASSERT_EQ(std::bit_cast<std::uint32_t>(text[i]), std::bit_cast<std::uint32_t>(twin))
          << "kind " << c.kind << ": " << text[i] << " by text, " << twin << " by twin, of " << f[i];
      const bool is_same = std::bit_cast<std::uint32_t>(text[i]) == std::bit_cast<std::uint32_t>(f[i]);
      ++(is_same ? seen.same : seen.changed)[c.kind];
    }
  }
}

// Ordinary densities, and now and then anything among the floats.
float anyDensity(std::mt19937& random, double most) {
  const auto unit = [&] { return static_cast<double>(random()) / 2147483648.0 - 1; };
  const std::array<double, 8> values = {most, -most, most * unit(), 1e-40 * unit(), 0.0, -0.0, 1e-30 * unit(), 60.0};
  const std::size_t pick = random() % 24;
  return static_cast<float>(pick < values.size() ? values[pick] : 200 * unit());
}

// For each largest density: profiles as steep as it, commands with strengths down to the denormals, and densities of
// either sign up to it. 1e17 apart on these voxels the square of a slope overflows already, and 1e38 apart a
// difference.
TEST(EditMath, DiffersInNoBitFromTheTwin) {
  std::mt19937 random(9);
  Lattice lattice;
  lattice.origin_W = {0.01, -0.02, 0.03};
  lattice.spacing_m = {0.7e-3, 0.9e-3, 1.3e-3};
  const Vec3i size(48, 40, 32);
  const EditScale scale = editScale(lattice.spacing_m);
  Seen seen;
  for (const double most : {200.0, 1e17, 1e30, static_cast<double>(FLT_MAX)}) {
    const BrushProfile profile = brushProfile(30, -most, most, lattice.spacing_m);
    const double named = std::min(most, kLargestDensity);
    RandomEdits edits(size, lattice, -named, named, 21);
    for (int n = 0; n < 400; ++n) {
      EditCommand command = edits.next();
      if (n % 4 == 0) command.strength = std::exp(-100 * edits.between(0, 1));
      const LoweredEdits lowered = lowerEdits(std::span(&command, 1), size, lattice, profile);
      compare(
          lowered.commands[0], scale, lowered.stamps, random, [&] { return anyDensity(random, most); }, seen);
      ASSERT_FALSE(HasFatalFailure()) << editName(command.kind) << ", densities up to " << most;
    }
  }
  for (std::size_t kind = 0; kind < EDIT_KINDS; ++kind) {  // there was something to compare
    EXPECT_GT(seen.changed[kind], 100) << kind;
    EXPECT_GT(seen.same[kind], 100) << kind;
  }
}

// The last voxels of a stamp's lattice, where the cell is the one before, and the first places beyond: by coordinates
// that are whole.
TEST(EditMath, MeetsTheTwinAtAStampsBorder) {
  Command c{};
  c.kind = EDIT_STAMP_ADD;
  c.strength = 1;
  c.reach = 4;
  c.isovalue = 1;
  c.object = 1000;
  c.slope = 1;
  c.m_xx = c.m_yy = c.m_zz = 1;
  c.stamp_first = 2;
  c.stamp_x = 4;
  c.stamp_y = 3;
  c.stamp_z = 2;
  const EditScale scale{1, 1, 1, 0, 0, 0, 1, 1, 1};
  std::vector<float> stamps = {-999, -999};
  for (int n = 0; n < 24; ++n)
    stamps.push_back(static_cast<float>(5 - n));  // depth n - 5 at voxel n, so the first is out of reach
  for (int k = -1; k <= 2; ++k) {
    for (int j = -1; j <= 3; ++j) {
      for (int first = -2; first <= 3; ++first) {
        const vec4 text = byText(c, scale, stamps, {first, j, k}, vec4(-100), {});
        for (int i = 0; i < 4; ++i) {
          const Vec3i voxel(first + i, j, k);
          const bool within = (voxel.array() >= 0).all() && (voxel.array() < Vec3i(4, 3, 2).array()).all();
          const int number = (voxel.z() * 3 + voxel.y()) * 4 + voxel.x();
          const float wanted = within && number > 0 ? static_cast<float>(number - 4) : -100.0F;
          EXPECT_EQ(text[i], wanted) << voxel.transpose();
          EXPECT_EQ(reference::editedDensity(c, scale, stamps, voxel, -100, {}), wanted) << voxel.transpose();
        }
      }
    }
  }
}

// ---- By hand. Voxels of 1 m, a ball of 8 m around the voxel (10, 20, 30) with a reach of 10 m. The isovalue is 32,
// the ramp 16 a metre, from -80 to 144. The voxel (13, 20, 34) is 5 m away, 3 m under the surface, (10, 29, 30) 1 m
// above. Figures are sums of powers of two, so every step is exact.

struct Hand {
  const char* what;
  layout::uint kind;
  float strength, inv_fade, value;
  Vec3i voxel;
  float before, after;
};

const Hand kByHand[] = {
    // 32 + 16 * 3 = 80
    {"fills up to the ramp", EDIT_ADD, 1, 0, 0, {13, 20, 34}, 0, 80},
    {"fills half way", EDIT_ADD, 0.5F, 0, 0, {13, 20, 34}, 0, 40},
    {"leaves what is denser", EDIT_ADD, 1, 0, 0, {13, 20, 34}, 96, 96},
    {"fills the middle up to the object", EDIT_ADD, 1, 0, 0, {10, 20, 30}, 0, 144},
    {"carries the ramp beyond the surface", EDIT_ADD, 1, 0, 0, {10, 29, 30}, 0, 16},
    {"goes on to its reach", EDIT_ADD, 1, 0, 0, {10, 30, 30}, -80, 0},
    {"ends beyond it", EDIT_ADD, 1, 0, 0, {10, 31, 30}, -96, -96},
    // 32 - 16 * 3 = -16
    {"clears down to the ramp", EDIT_REMOVE, 1, 0, 0, {13, 20, 34}, 160, -16},
    {"clears the middle down to the background", EDIT_REMOVE, 1, 0, 0, {10, 20, 30}, 160, -80},
    // s = 3 / 4: s s (3 - 2 s) = 27 / 32 of the way from 160 to -16
    {"fades", EDIT_REMOVE, 1, 0.25F, 0, {13, 20, 34}, 160, 11.5F},
    {"paints a quarter of the way", EDIT_PAINT, 0.25F, 0, 64, {13, 20, 34}, 16, 28},
    // the plane j = 20 + 2: the voxel is 2 m under it; (10, 25, 30) is 3 m above, and 5 m away
    {"flattens under the plane", EDIT_FLATTEN, 1, 0, 0, {13, 20, 34}, 0, 64},
    {"flattens above the plane", EDIT_FLATTEN, 1, 0, 0, {10, 25, 30}, 160, -16},
    {"cuts off", EDIT_CUT, 1, 0, 0, {10, 25, 30}, 160, -16},
    {"cuts as deep as its reach", EDIT_CUT, 1, 0, 0, {10, 20, 30}, 160, 64},
    {"keeps what lies deep under the cut", EDIT_CUT, 1, 0, 0, {10, 11, 30}, 160, 160},
    // the neighbours are 8 denser before, 24 after, along i, and as dense as the voxel along j and k: a quarter of 8 +
    // 24
    {"evens out", EDIT_SMOOTH, 1, 0, 0, {13, 20, 34}, 16, 24},
    // the steepest rise is 24 a metre; the step half a metre
    {"inflates", EDIT_INFLATE, 1, 0, 0.5F, {13, 20, 34}, 16, 28},
    {"deflates nothing in a hollow", EDIT_DEFLATE, 1, 0, 0.5F, {13, 20, 34}, 16, 16},
};

class ByHand : public testing::TestWithParam<Hand> {};

TEST_P(ByHand, AreTextAndTwin) {
  const Hand& hand = GetParam();
  Command c{};
  c.kind = hand.kind;
  c.origin_x = 10;
  c.origin_y = 20;
  c.origin_z = 30;
  c.radius = 8;
  c.reach = hand.kind == EDIT_CUT ? 2.0F : 10.0F;
  c.strength = hand.strength;
  c.inv_fade = hand.inv_fade;
  c.value = hand.value;
  c.n_y = 1;
  c.n_d = 2;
  c.isovalue = 32;
  c.background = -80;
  c.object = 144;
  c.slope = 16;
  const EditScale scale{1, 1, 1, 0.25F, 0.25F, 0.25F, 1, 1, 1};
  const float f = hand.before;
  const Neighbours around{{f + 8, f, f}, {f + 24, f, f}};
  EXPECT_EQ(byText(c, scale, {}, hand.voxel, vec4(f), {around, around, around, around})[0], hand.after) << hand.what;
  EXPECT_EQ(reference::editedDensity(c, scale, {}, hand.voxel, f, around), hand.after) << hand.what;
}

INSTANTIATE_TEST_SUITE_P(Figures, ByHand, testing::ValuesIn(kByHand));

// A stroke from (0, 0, 0) to (8, 0, 0): beside it the distance is across, beyond its ends from the end. Material: half
// way from 0 to 64 half of the drop counts.
TEST(EditMath, MeasuresFromAStrokeAndWeighsMaterial) {
  Command c{};
  c.kind = EDIT_REMOVE;
  c.ab_x = 8;
  c.inv_ab2 = 1.0F / 64;
  c.radius = 8;
  c.reach = 10;
  c.strength = 1;
  c.isovalue = 32;
  c.background = -96;
  c.slope = 16;
  c.material_inv_range = 1.0F / 64;
  const EditScale scale{1, 1, 1, 0, 0, 0, 1, 1, 1};
  const auto expect = [&](const Vec3i& voxel, float before, float after) {
    EXPECT_EQ(byText(c, scale, {}, voxel, vec4(before), {})[0], after) << voxel.transpose();
    EXPECT_EQ(reference::editedDensity(c, scale, {}, voxel, before, {}), after) << voxel.transpose();
  };
  expect({4, 3, 4}, 160, -16);   // 5 m beside it: 32 - 16 * 3
  expect({12, 3, 0}, 160, -16);  // 5 m beyond its end
  expect({-4, 0, 3}, 160, -16);  // and before its start
  expect({4, 9, 0}, 160, 48);    // 1 m above the surface: 32 + 16
  expect({4, 11, 0}, 160, 160);  // out of reach
  c.material_drop = 0.5F;
  expect({4, 3, 4}, 32, -4);   // 3/4 of the way from 32 to -16
  expect({4, 3, 4}, 64, 24);   // half of the way from 64 to -16: 64 is as hard as it gets
  expect({4, 3, 4}, 160, 72);  // and so is 160
}

}  // namespace edit_math_test
}  // namespace palpate
