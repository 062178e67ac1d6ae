// SPDX-License-Identifier: Apache-2.0
// How much less a small brush removes or adds than its volume, and where the surface lies with a falloff: what is said
// of it (docs/edits.md) against edits of the reference, whose trilinear surface is measured.
#include "engine/edit/brush_profile.hpp"

#include <cmath>
#include <numbers>
#include <random>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/edit/lower_edit.hpp"
#include "engine/reference/edit.hpp"
#include "engine/reference/isosurface.hpp"

namespace palpate {
namespace brush_profile_test {

using reference::DenseField;
using testing::HasSubstr;

constexpr double kTau = 30, kBackground = -100, kObject = 200;

Lattice latticeOf(const Vec3& spacing_m) {
  return {Vec3::Zero(), Mat3::Identity(), spacing_m};
}

EditCommand brush(EditKind kind, const Vec3& from_W, const Vec3& to_W, double radius_m) {
  EditCommand command;
  command.kind = kind;
  command.from_W = from_W;
  command.to_W = to_W;
  command.radius_m = radius_m;
  return command;
}

// The effect of commands on a volume of object (background, for an add).
DenseField edited(const std::vector<EditCommand>& commands, const Vec3i& size, const Lattice& lattice,
                  double tau = kTau) {
  const double before = commands[0].kind == EditKind::kAdd ? kBackground : kObject;
  DenseField field{size, lattice,
                   std::vector<float>(static_cast<std::size_t>(size.prod()), static_cast<float>(before))};
  const BrushProfile profile = brushProfile(tau, kBackground, kObject, lattice.spacing_m);
  reference::applyEdits(field, lowerEdits(commands, size, lattice, profile));
  return field;
}

// The volume of what changed sides, by points: kAcross^3 in each cell.
double changedVolume(const DenseField& field, bool added, double tau) {
  constexpr int kAcross = 6;
  const Vec3i points = (field.size - Vec3i::Ones()) * kAcross;
  long inside = 0;
  for (int k = 0; k < points.z(); ++k) {
    for (int j = 0; j < points.y(); ++j) {
      for (int i = 0; i < points.x(); ++i) {
        const Vec3 p_L = (Vec3(i, j, k).array() + 0.5) / kAcross;
        inside += (reference::trilinear(field, p_L) > tau) == added ? 1 : 0;
      }
    }
  }
  return static_cast<double>(inside) * field.lattice.spacing_m.prod() / (kAcross * kAcross * kAcross);
}

// The share that is missing of what surfaceRadius() leaves of a brush, on average over places between voxels. `times`:
// strokes in the same place.
double missing(EditCommand command, const Lattice& lattice, double tau, std::mt19937& random, int times = 1) {
  constexpr int kPlaces = 6;
  std::uniform_real_distribution<double> share(-0.5, 0.5);
  const Vec3 along = command.to_W - command.from_W;
  const double reach_m = 2 * (command.radius_m + 1.5 * lattice.spacing_m.maxCoeff());
  const Vec3i size =
      ((along.cwiseAbs() + Vec3::Constant(reach_m)).cwiseQuotient(lattice.spacing_m)).array().ceil().cast<int>();
  double sum = 0;
  for (int n = 0; n < kPlaces; ++n) {
    const Vec3 middle_W = lattice.toWorld(0.5 * (size - Vec3i::Ones()).cast<double>() +
                                          Vec3(share(random), share(random), share(random)));
    command.from_W = middle_W - along / 2;
    command.to_W = middle_W + along / 2;
    const std::vector<EditCommand> strokes(static_cast<std::size_t>(times), command);
    sum += changedVolume(edited(strokes, size, lattice, tau), command.kind == EditKind::kAdd, tau);
  }
  const double r = surfaceRadius(command, lattice, times > 1 ? Strokes::kMany : Strokes::kOne);
  return 1 - sum / kPlaces / (std::numbers::pi * r * r * (4.0 / 3 * r + along.norm()));
}

// A brush at random places between voxels. What the formula leaves out are terms of (h/r)^4, 1/16 at r = 2 h, times
// coefficients below 1, and how far the mean over a few places is off: 0.045 where the radius is no less than a
// spacing. At 0.7 of one the series is of little use: 0.11.
TEST(BrushShortfall, IsWhatIsMissingOnAverage) {
  std::mt19937 random(4);
  for (const Vec3& spacing : {Vec3(1, 1, 1), Vec3(1, 1, 2.1), Vec3(0.8, 1.2, 1.0)}) {
    const Lattice lattice = latticeOf(1e-3 * spacing);
    for (const double radius_m : {1.5e-3, 2e-3, 3e-3}) {
      for (const double length_m : {0.0, 6e-3}) {
        for (const EditKind kind : {EditKind::kRemove, EditKind::kAdd}) {
          const EditCommand command = brush(kind, Vec3::Zero(), Vec3(1, 0.4, 0.2).normalized() * length_m, radius_m);
          EXPECT_NEAR(brushShortfall(command, lattice), missing(command, lattice, kTau, random),
                      spacing.maxCoeff() * 1e-3 <= radius_m ? 0.045 : 0.11)
              << radius_m << " m in voxels of " << spacing.transpose() << " mm, " << length_m << " m long";
        }
      }
    }
  }
}

// With a falloff there is a step or a bend at the rim, so what is left out is more: 0.12 where the surface is to lie a
// spacing or more from the middle. With equal contrasts on both sides of the isovalue.
TEST(BrushShortfall, HoldsWithAFalloffToo) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> share(0, 1);
  int told = 0, compared = 0;
  for (int n = 0; n < 60; ++n) {
    const Lattice lattice = latticeOf(1e-3 * Vec3(1, 1, 1 + share(random)));
    const Vec3 along = Vec3(share(random), share(random), share(random)).normalized() * (n % 2 == 0 ? 0.0 : 6e-3);
    EditCommand command =
        brush(n % 3 == 0 ? EditKind::kAdd : EditKind::kRemove, Vec3::Zero(), along, 1e-3 * (1.5 + 2.5 * share(random)));
    command.falloff = 0.05 + 0.95 * share(random);
    const Strokes strokes = n % 4 < 2 ? Strokes::kOne : Strokes::kMany;
    const double r_m = surfaceRadius(command, lattice, strokes);
    if (r_m < lattice.spacing_m.maxCoeff()) continue;
    const double expected = brushShortfall(command, lattice, strokes);
    const double found =
        missing(command, lattice, (kBackground + kObject) / 2, random, strokes == Strokes::kOne ? 1 : 400);
    ++compared;
    told += expected > kToldShortfall ? 1 : 0;
    EXPECT_NEAR(expected, found, 0.12) << fmt::format(
        "{}: {} mm, falloff {}, slices of {} mm, {} mm long, surface at {} mm", n, 1e3 * command.radius_m,
        command.falloff, 1e3 * lattice.spacing_m.z(), 1e3 * along.norm(), 1e3 * r_m);
  }
  EXPECT_GT(compared, 30);
  EXPECT_GT(told, compared / 4);
  EXPECT_LT(told, compared);
}

TEST(BrushShortfall, IsOfOneStrokeOrOfManyInItsPlace) {
  const Lattice lattice = latticeOf(Vec3::Constant(1e-3));
  EditCommand command = brush(EditKind::kAdd, Vec3::Zero(), Vec3::Zero(), 2e-3);
  EXPECT_EQ(brushShortfall(command, lattice, Strokes::kMany), brushShortfall(command, lattice));
  command.falloff = 0.5;
  EXPECT_EQ(surfaceRadius(command, lattice, Strokes::kMany), 2e-3);
  EXPECT_LT(surfaceRadius(command, lattice), 1.5e-3);
  command.kind = EditKind::kSmooth;  // makes no surface
  EXPECT_EQ(surfaceRadius(command, lattice), 2e-3);
}

TEST(BrushShortfall, HasTheWorkedFiguresOfThePage) {
  const auto ball = [](double radius, const Vec3& spacing) {
    return brushShortfall(brush(EditKind::kRemove, Vec3::Zero(), Vec3::Zero(), radius), latticeOf(spacing));
  };
  EXPECT_NEAR(ball(2, Vec3::Ones()), 0.12, 0.005);
  EXPECT_NEAR(ball(1.5, Vec3::Ones()), 0.21, 0.005);
  EXPECT_NEAR(ball(1.5, {1, 1, 2.1}), 0.40, 0.005);
  EXPECT_EQ(ball(0.1, Vec3::Ones()), 1);
  EditCommand fading = brush(EditKind::kRemove, Vec3::Zero(), Vec3::Zero(), 2);
  fading.falloff = 0.5;
  EXPECT_NEAR(brushShortfall(fading, latticeOf(Vec3::Ones())), 0.38, 0.005);
  EXPECT_NEAR(brushShortfall(fading, latticeOf(Vec3::Ones()), Strokes::kMany), 0.54, 0.005);
  fading.radius_m = 4;
  EXPECT_NEAR(brushShortfall(fading, latticeOf(Vec3::Ones()), Strokes::kMany), 0.27, 0.005);
}

TEST(FineBrushWarning, IsForBrushesThatFallShort) {
  const Lattice lattice = latticeOf({1e-3, 1e-3, 2.1e-3});
  const auto words = [&](EditCommand command) { return fineBrushWarning(command, lattice); };
  EditCommand command = brush(EditKind::kRemove, Vec3::Zero(), Vec3::Zero(), 1.5e-3);
  EXPECT_THAT(words(command), HasSubstr("its radius is 1.5 mm, 1.5 x 1.5 x 0.71 voxels; of what is within, it removes "
                                        "some 60 %, since"));
  EXPECT_THAT(words(command), HasSubstr("give a larger radius, or resample"));
  command.kind = EditKind::kAdd;
  EXPECT_THAT(words(command), HasSubstr("it adds some 60 %"));
  command.falloff = 0.5;
  EXPECT_THAT(words(command),
              HasSubstr("one stroke with its falloff of 0.5 is to have its surface at a radius of 0.914 "
                        "mm, 0.91 x 0.91 x 0.44 voxels; of what is within, it adds some part or nothing"));
  EXPECT_THAT(words(command), HasSubstr("give a larger radius or no falloff, or resample"));
  EXPECT_THAT(fineBrushWarning(command, lattice, Strokes::kMany), HasSubstr("its radius is 1.5 mm, 1.5 x"));
  command.radius_m = 4e-3;
  EXPECT_THAT(fineBrushWarning(command, lattice, Strokes::kMany), HasSubstr("of what is within, it adds some 5"));
  command.radius_m = 1.5e-3;
  command.falloff = 0;
  command.kind = EditKind::kSmooth;  // makes no surface of its own
  EXPECT_EQ(words(command), "");
  command.radius_m = 0.4e-3;
  EXPECT_THAT(words(command), HasSubstr("below half a voxel"));
  EXPECT_THAT(words(command), HasSubstr("change up to 0.4 mm around"));  // it ends at its radius
  command.kind = EditKind::kAdd;
  EXPECT_THAT(words(command), HasSubstr("change up to 4.6 mm around"));  // and two voxels of 2.1 mm
  command.falloff = 0.5;
  EXPECT_THAT(words(command), HasSubstr("change up to 0.4 mm around"));
  EXPECT_EQ(words(brush(EditKind::kRemove, Vec3::Zero(), Vec3::Zero(), 4e-3)), "");
}

// A brush of many voxels, so that the trilinear surface is that of the formula: what is interpolated is smooth over F,
// and errs by h^2 / 8 times its second derivatives. On F = 8 voxels and more those are below 6 / F of the slope: 0.1
// voxel.
TEST(Falloff, PutsTheSurfaceWhereThePageSays) {
  const Lattice lattice = latticeOf(Vec3::Constant(1e-3));
  const Vec3i size = Vec3i::Constant(49);
  const Vec3 middle_W = Vec3::Constant(24e-3);
  const BrushProfile profile = brushProfile(kTau, kBackground, kObject, lattice.spacing_m);
  for (const EditKind kind : {EditKind::kRemove, EditKind::kAdd}) {
    for (const double falloff : {0.4, 0.7, 1.0}) {
      EditCommand command = brush(kind, middle_W, middle_W, 20e-3);
      command.falloff = falloff;
      const DenseField field = edited({command}, size, lattice);
      const double f = kind == EditKind::kAdd ? kBackground : kObject, fade_m = falloff * command.radius_m;
      const double most = kind == EditKind::kAdd ? kObject - kTau : kTau - kBackground;
      // (1 - w) |f - tau| = w min(slope u, most)
      double low = 0, high = fade_m;
      for (int n = 0; n < 60; ++n) {
        const double u = (low + high) / 2, s = u / fade_m, w = s * s * (3 - 2 * s);
        ((1 - w) * std::abs(f - kTau) > w * std::min(profile.slope_per_m * u, most) ? low : high) = u;
      }
      const double expected_m = command.radius_m - low;
      double near = 0, far = 24;  // [voxel], from the middle along an axis
      const bool inside_near = reference::trilinear(field, Vec3::Constant(24)) > kTau;
      for (int n = 0; n < 60; ++n) {
        const double at = (near + far) / 2;
        ((reference::trilinear(field, Vec3(24 + at, 24, 24)) > kTau) == inside_near ? near : far) = at;
      }
      EXPECT_NEAR(near * 1e-3, expected_m, 0.1e-3) << falloff;
      EXPECT_LT(expected_m, command.radius_m - 1e-3) << falloff;
    }
  }
}

}  // namespace brush_profile_test
}  // namespace palpate
