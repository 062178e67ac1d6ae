// SPDX-License-Identifier: Apache-2.0
#include "engine/phantoms/phantom.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <random>
#include <set>
#include <tuple>

#include "engine/files/volume_file.hpp"
#include "tests/engine/files/files.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/typo.hpp"

namespace palpate {
namespace phantom_test {

// Points of the lattice's box, the same on every machine.
class Points {
 public:
  explicit Points(const Phantom& phantom) : half_m_(-phantom.lattice().origin_W) {}

  Vec3 next() { return half_m_.cwiseProduct(Vec3(unit(), unit(), unit())); }
  Vec3 direction() {
    Vec3 v(unit(), unit(), unit());
    while (v.norm() > 1 || v.norm() < 0.1) v = Vec3(unit(), unit(), unit());
    return v.normalized();
  }
  double unit() { return static_cast<double>(bits_() >> 11U) * 0x1p-52 - 1; }  // in [-1, 1)

 private:
  std::mt19937_64 bits_{7};
  Vec3 half_m_;
};

double halfDiagonal_m(const Phantom& phantom) {
  return phantom.lattice().origin_W.norm();
}

class Surface : public testing::TestWithParam<std::string> {
 protected:
  std::unique_ptr<Phantom> phantom_ = makePhantom(GetParam());
};

// A distance cannot change faster than the point moves.
TEST_P(Surface, DistanceIsLipschitz) {
  Points points(*phantom_);
  for (int n = 0; n < 4000; ++n) {
    const Vec3 a = points.next();
    const Vec3 b = n % 2 == 0 ? points.next() : Vec3(a + points.direction() * 1e-3 * halfDiagonal_m(*phantom_));
    const double change = std::abs(phantom_->signedDistance_m(a) - phantom_->signedDistance_m(b));
    ASSERT_LE(change, (a - b).norm() * (1 + 1e-9) + 1e-12) << a.transpose() << " to " << b.transpose();
  }
}

// Central differences of step h err by h^2 / (6 r^2) from curvature 1/r, here below 1e-8, and by rounding, 1e-16 /
// 1e-6. A point within h of the medial axis would fail, but none of these is.
TEST_P(Surface, GradientIsOneAndIsTheNormal) {
  Points points(*phantom_);
  const double h_m = 1e-6 * halfDiagonal_m(*phantom_);
  const double near_m = 3 * phantom_->lattice().spacing_m.maxCoeff();
  int checked = 0;
  for (int n = 0; n < 20000 && checked < 500; ++n) {
    const Vec3 p_W = points.next();
    const SurfaceOffset offset = phantom_->offset(p_W);
    if (std::abs(offset.distance_m) > near_m) continue;
    ++checked;
    Vec3 gradient;
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 step = Vec3::Unit(axis) * h_m;
      gradient[axis] = (phantom_->signedDistance_m(p_W + step) - phantom_->signedDistance_m(p_W - step)) / (2 * h_m);
    }
    ASSERT_NEAR(gradient.norm(), 1, 1e-6) << p_W.transpose();
    ASSERT_LE((gradient - offset.normal).norm(), 1e-6) << p_W.transpose();
    ASSERT_NEAR(offset.normal.norm(), 1, 1e-12);
  }
  EXPECT_GE(checked, 100);
}

// No point of the open ball of that radius has the other sign: the distance is not too large.
TEST_P(Surface, BallOfTheDistanceHoldsNoSurface) {
  Points points(*phantom_);
  for (int n = 0; n < 1000; ++n) {
    const Vec3 p_W = points.next();
    const double distance_m = phantom_->signedDistance_m(p_W);
    for (int probe = 0; probe < 20; ++probe) {
      const Vec3 q_W = p_W + points.direction() * std::abs(distance_m) * (1 - 1e-9);
      ASSERT_GE(phantom_->signedDistance_m(q_W) * std::copysign(1.0, distance_m), -1e-12) << p_W.transpose();
    }
  }
}

// Walks from random points to the surface; there the density is the isovalue.
TEST_P(Surface, DensityOnTheSurfaceIsTheIsovalue) {
  Points points(*phantom_);
  for (int n = 0; n < 500; ++n) {
    Vec3 p_W = points.next();
    for (int step = 0; step < 50; ++step) {
      const SurfaceOffset offset = phantom_->offset(p_W);
      p_W -= offset.distance_m * offset.normal;
    }
    const double distance_m = phantom_->signedDistance_m(p_W);
    if (std::abs(distance_m) > 1e-12) continue;  // caught at an inner edge of two bodies
    ASSERT_NEAR(phantom_->density(p_W), phantom_->isovalue(), 1e-6) << p_W.transpose();
  }
}

// Blocks that are skipped as constant hold what the density function says, at odd sizes too.
TEST_P(Surface, VoxelsAreTheDensity) {
  std::string small = GetParam().substr(0, GetParam().find('?')) + "?size=21x30x17&spacing=2x1.5x2.5mm";
  const auto phantom = makePhantom(small);
  const Volume volume = makeVolume(*phantom);
  EXPECT_EQ(volume.size(), Vec3i(21, 30, 17));
  for (int n = 0; n < 21 * 30 * 17; ++n) {
    const Vec3i index(n % 21, n / 21 % 30, n / 630);
    const Vec3 p_W = phantom->lattice().toWorld(index.cast<double>());
    ASSERT_EQ(volume.value(index), static_cast<float>(phantom->density(p_W))) << index.transpose();
  }
}

TEST_P(Surface, HasBothSidesInTheLattice) {
  const Volume volume = makeVolume(*phantom_);
  EXPECT_LT(volume.minimum(), phantom_->isovalue());
  EXPECT_GT(volume.maximum(), phantom_->isovalue());
  EXPECT_EQ(volume.facts().declared_isovalue, phantom_->isovalue());
  EXPECT_LE((volume.lattice().toWorld((volume.size() - Vec3i::Ones()).cast<double>() / 2)).norm(), 1e-12);
}

INSTANTIATE_TEST_SUITE_P(All, Surface,
                         testing::Values("phantom:sphere", "phantom:sphere?size=33x40x51&spacing=0.5x0.5x1.2mm",
                                         "phantom:box", "phantom:spheres", "phantom:knot", "phantom:shell?thickness=3",
                                         "phantom:gyroid", "phantom:head", "phantom:lung"),
                         [](const auto& spec) {
                           std::string name = spec.param.substr(8, spec.param.find('?') - 8);
                           return name + std::to_string(spec.index);
                         });

// Where the distance is exact everywhere, the foot point p - d n lies on the surface: the distance is not too small.
class ExactSurface : public testing::TestWithParam<std::string> {};

TEST_P(ExactSurface, FootPointsLieOnTheSurface) {
  const auto phantom = makePhantom(GetParam());
  Points points(*phantom);
  for (int n = 0; n < 2000; ++n) {
    const Vec3 p_W = points.next();
    const SurfaceOffset offset = phantom->offset(p_W);
    ASSERT_NEAR(phantom->signedDistance_m(p_W - offset.distance_m * offset.normal), 0, 1e-12) << p_W.transpose();
  }
}

INSTANTIATE_TEST_SUITE_P(Exact, ExactSurface,
                         testing::Values("phantom:sphere", "phantom:box", "phantom:spheres", "phantom:knot",
                                         "phantom:shell", "phantom:gyroid"));

// The knot's centre curve, sampled finely: the nearest sample is at most (arc / 2)^2 / (2 d) farther than the curve.
TEST(Knot, DistanceAgreesWithAFineSampling) {
  const auto phantom = makePhantom("phantom:knot");
  constexpr double kScale_m = 0.0315;
  constexpr int kSamples = 20000;
  Points points(*phantom);
  for (int n = 0; n < 100; ++n) {
    const Vec3 p_W = points.next();
    double nearest_m = 1;
    for (int sample = 0; sample < kSamples; ++sample) {
      const double t = sample * 2 * M_PI / kSamples;
      const double r = 0.55 + 0.25 * std::cos(3 * t);
      const Vec3 c = kScale_m * Vec3(r * std::cos(2 * t), r * std::sin(2 * t), 0.25 * std::sin(3 * t));
      nearest_m = std::min(nearest_m, (p_W - c).norm());
    }
    const double arc_m = 2.35 * kScale_m * 2 * M_PI / kSamples;
    const double exact_m = phantom->signedDistance_m(p_W) + 0.13 * kScale_m;
    ASSERT_LE(exact_m, nearest_m + 1e-15);
    ASSERT_GE(exact_m, nearest_m - std::min(arc_m, arc_m * arc_m / 8 / std::max(exact_m, 1e-9)) * 1.5);
  }
}

// In a flat lattice it is as wide as the lattice, not as a cube of its height; in one flatter still its height decides.
TEST(Knot, FillsAFlatLattice) {
  const auto gap_m = [](const char* name) { return makePhantom(name)->signedDistance_m(Vec3::Zero()); };
  // At the centre the distance is that of the nearest point of the centre curve (A - B) less the tube: 0.17 scales.
  EXPECT_NEAR(gap_m("phantom:knot?size=128x128x64"), 0.17 * 0.0635, 1e-12);
  EXPECT_NEAR(gap_m("phantom:knot?size=128x128x128"), 0.17 * 0.0635, 1e-12);
  EXPECT_NEAR(gap_m("phantom:knot?size=128x128x33"), 0.17 * 0.016 * (0.93 / 0.38), 1e-12);
}

// Trilinear interpolation errs by at most sum h^2 / 8 times the second derivative, here the slope times the curvature
// 1 / r of the distance's level sets within a voxel's diagonal of the surface.
TEST(Sphere, VoxelsInterpolateToTheIsovalueOnTheSurface) {
  const auto phantom = makePhantom("phantom:sphere");
  const Volume volume = makeVolume(*phantom);
  const double h_m = 1e-3;
  const double radius_m = 0.7 * 0.0315;
  const double bound = phantom->profile().slope_per_m * 2 * h_m * h_m / 8 / (radius_m - std::sqrt(3.0) * h_m);
  Points points(*phantom);
  double worst = 0;
  for (int n = 0; n < 2000; ++n) {
    double density = 0;
    Vec3 gradient;
    const Vec3 direction = points.direction();
    ASSERT_TRUE(volume.sample(direction * radius_m, density, gradient));
    worst = std::max(worst, std::abs(density - phantom->isovalue()));
    EXPECT_GT(-gradient.normalized().dot(direction), 0.999);
  }
  EXPECT_LE(worst, bound);
  EXPECT_GE(worst, bound / 100);  // the bound is not loose by orders
}

// A density at a place of the natural lattice [m], 512 voxels wide, so that ramps are thin.
double densityAt(const char* name, double x, double y, double z) {
  return makePhantom(std::string("phantom:") + name + "?size=512")->density({x, y, z});
}

// Middles of the tissues, farther from every border than a ramp is wide (the hole's axis leaves the skull's middle at
// 69 mm from the head's), on both sides of what there is twice.
TEST(Head, HasItsTissues) {
  EXPECT_EQ(densityAt("head", 0.090, 0, 0), -1000);        // air
  EXPECT_EQ(densityAt("head", 0.0705, 0, 0), 40);          // scalp
  EXPECT_EQ(densityAt("head", 0.062, 0, 0), 1000);         // skull
  EXPECT_EQ(densityAt("head", 0, -0.079, 0), 1000);        // in front
  EXPECT_EQ(densityAt("head", 0, 0, -0.075), 1000);        // below
  EXPECT_EQ(densityAt("head", 0.0416, 0, 0.0555), 40);     // in the drilled hole
  EXPECT_EQ(densityAt("head", -0.0416, 0, 0.0555), 1000);  // and the bone opposite
  EXPECT_EQ(densityAt("head", 0, -0.052, -0.038), 1000);   // face
  EXPECT_DOUBLE_EQ(densityAt("head", 0.03, 0.01, -0.02), 30);
  for (const double side : {-1.0, 1.0}) {
    EXPECT_EQ(densityAt("head", side * 0.013, -0.054, -0.038), -1000);   // sinus
    EXPECT_DOUBLE_EQ(densityAt("head", side * 0.010, 0.015, 0.010), 8);  // ventricle
  }
}

// A body that runs through the lattice along z; vessels of three generations: the trunk's middle, a branch's and that
// of one that leaves the plane.
TEST(Lung, HasItsTissues) {
  EXPECT_EQ(densityAt("lung", 0.165, 0, 0), -1000);
  EXPECT_EQ(densityAt("lung", 0, -0.115, 0.1), -1000);
  for (const double z : {-0.15, 0.0, 0.1}) {
    EXPECT_EQ(densityAt("lung", 0.138, 0, z), 40);   // wall
    EXPECT_EQ(densityAt("lung", 0, 0.075, z), 700);  // spine
  }
  for (const double side : {-1.0, 1.0}) {
    EXPECT_EQ(densityAt("lung", side * 0.07, -0.06, 0.06), -850);
    EXPECT_EQ(densityAt("lung", side * 0.07, 0.05, 0), -850);
    EXPECT_EQ(densityAt("lung", side * 0.0375, 0, 0), 40);
    for (const double up : {-1.0, 1.0}) {
      EXPECT_EQ(densityAt("lung", side * 0.0657, 0, up * 0.009), 40);
      EXPECT_EQ(densityAt("lung", side * 0.0830, 0.0072, up * 0.0235), 40);
      EXPECT_EQ(densityAt("lung", side * 0.0830, -0.0072, up * 0.0235), 40);
    }
  }
}

// Lengths follow the lattice: 32, 39 and 50 spacings of 0.5, 0.5 and 1.2 mm are half extents of 8, 9.75 and 30 mm. A
// ramp is three of the largest spacing long.
TEST(SimplePhantoms, HaveTheirSizes) {
  const auto of = [](const char* name) {
    return makePhantom(std::string("phantom:") + name + "?size=33x40x51&spacing=0.5x0.5x1.2mm");
  };
  const auto sphere = of("sphere"), box = of("box"), shell = of("shell");
  EXPECT_NEAR(sphere->signedDistance_m({0, 0, 0}), -0.7 * 8e-3, 1e-12);
  EXPECT_NEAR(sphere->profile().slope_per_m, 1000 / 3.6e-3, 1e-6);
  EXPECT_NEAR(box->signedDistance_m({0, 0, 0}), -0.6 * 8e-3, 1e-12);
  EXPECT_NEAR(box->signedDistance_m({0, 0.6 * 9.75e-3, 0}), 0, 1e-12);
  EXPECT_NEAR(box->signedDistance_m({0, 0, 0.6 * 30e-3 + 1e-3}), 1e-3, 1e-12);
  EXPECT_NEAR(shell->signedDistance_m({5.6e-3, 0, 0}), -1.2e-3, 1e-12);  // two spacings thick
  EXPECT_NEAR(shell->signedDistance_m({0, 0, 0}), 5.6e-3 - 1.2e-3, 1e-12);
  const auto spheres = makePhantom("phantom:spheres");
  constexpr double kHalf_m = 0.0315;
  for (const auto& [centre, radius, density] :
       {std::tuple(Vec3(-0.45, -0.35, -0.20), 0.38, 600.0), std::tuple(Vec3(0.50, -0.25, 0.25), 0.28, 1000.0),
        std::tuple(Vec3(0.00, 0.50, 0.10), 0.25, 1400.0)}) {
    EXPECT_NEAR(spheres->signedDistance_m(centre * kHalf_m), -radius * kHalf_m, 1e-12);
    EXPECT_EQ(spheres->density(centre * kHalf_m), density);
  }
  EXPECT_EQ(spheres->density(Vec3(-1, 1, 1) * kHalf_m), -1000);
}

TEST(PhantomVolume, SaysWhatItIs) {
  for (const char* name : {"phantom:box?size=9", "phantom:box?size=9&noise=0.1"}) {
    const Volume volume = makeVolume(*makePhantom(name));
    const VolumeFacts& facts = volume.facts();
    EXPECT_EQ(facts.source, name);
    EXPECT_EQ(facts.format, "phantom");
    EXPECT_EQ(facts.value_type, "float32");
    EXPECT_EQ(facts.orientation, "LPS axes, centred on the world's origin");
    EXPECT_EQ(facts.declared_isovalue, 0);
  }
}

TEST(Noise, HasItsDeviationAndIsSeeded) {
  const auto clean = makePhantom("phantom:sphere");
  const auto noisy = makePhantom("phantom:sphere?noise=0.05&seed=3");
  const std::vector<float> want = makeVolume(*clean).toDense();
  const std::vector<float> got = makeVolume(*noisy).toDense();
  double sum = 0;
  double squares = 0;
  for (std::size_t n = 0; n < want.size(); ++n) {
    const double noise = static_cast<double>(got[n]) - static_cast<double>(want[n]);
    sum += noise;
    squares += noise * noise;
  }
  const auto count = static_cast<double>(want.size());  // 262144: the deviation's own error is 1 / sqrt(2 n) = 0.14 %
  EXPECT_NEAR(sum / count, 0, 100 * 4 / std::sqrt(count));
  EXPECT_NEAR(std::sqrt(squares / count), 100, 100 * 4 / std::sqrt(2 * count));
  EXPECT_EQ(got, makeVolume(*noisy).toDense());
  EXPECT_NE(got, loadVolume("phantom:sphere?noise=0.05&seed=4").toDense());
}

TEST(Random, HoldsEveryKindOfValueAndHasNoSurface) {
  const auto phantom = makePhantom("phantom:random?size=16");
  EXPECT_FALSE(phantom->hasSurface());
  EXPECT_TRUE(std::isnan(phantom->signedDistance_m(Vec3::Zero())));
  std::set<std::string> kinds;
  for (const float value : makeVolume(*phantom).toDense()) {
    if (value == 0) kinds.insert(std::signbit(value) ? "-0" : "+0");
    if (std::fpclassify(value) == FP_SUBNORMAL) kinds.insert(value < 0 ? "-denormal" : "+denormal");
    if (std::abs(value) == 1e-30F) kinds.insert(value < 0 ? "-tiny" : "+tiny");
    if (std::abs(value) == 1e30F) kinds.insert(value < 0 ? "-huge" : "+huge");
    if (std::abs(value) > 1 && std::abs(value) <= 1024) kinds.insert("ordinary");
  }
  EXPECT_EQ(kinds.size(), 9U);
}

// A fifth of each kind, half of them negative: binomial, so within 5 deviations of sqrt(n p (1 - p)).
TEST(Random, HasAsManyOfEachKind) {
  std::array<int, 5> counts{};
  int negative = 0;
  const std::vector<float> values = makeVolume(*makePhantom("phantom:random?size=32")).toDense();
  for (const float value : values) {
    const float size = std::abs(value);
    const std::size_t kind = size == 0                                ? 0
                             : std::fpclassify(value) == FP_SUBNORMAL ? 1
                             : size == 1e-30F                         ? 2
                             : size == 1e30F                          ? 3
                                                                      : 4;
    ++counts[kind];
    negative += std::signbit(value) ? 1 : 0;
  }
  const auto all = static_cast<double>(values.size());
  for (const int count : counts) EXPECT_NEAR(count, all / 5, 5 * std::sqrt(all * 0.16));
  EXPECT_NEAR(negative, all / 2, 5 * std::sqrt(all * 0.25));
  EXPECT_NE(values, makeVolume(*makePhantom("phantom:random?size=32&seed=2")).toDense());
}

TEST(PhantomSpec, ReadsEveryKey) {
  const PhantomSpec spec =
      parsePhantomSpec("phantom:shell?size=128x64x32&spacing=0.5x500x1.2um&noise=0.05&seed=9&thickness=1.5");
  EXPECT_EQ(spec.size, Vec3i(128, 64, 32));
  EXPECT_LE((spec.spacing_m - Vec3(0.5e-6, 5e-4, 1.2e-6)).norm(), 1e-18);
  EXPECT_EQ(spec.noise, 0.05);
  EXPECT_EQ(spec.seed, 9U);
  EXPECT_EQ(spec.thickness_voxels, 1.5);
  EXPECT_EQ(parsePhantomSpec("phantom:sphere?size=32").spacing_m, Vec3::Constant(1e-3));
  EXPECT_EQ(parsePhantomSpec("phantom:head").size, Vec3i(128, 128, 64));
  EXPECT_NEAR(parsePhantomSpec("phantom:head?size=64").spacing_m.x(), 0.0032, 1e-12);  // the same head, coarser
}

TEST(PhantomSpec, HasASizeAndASpacingOfItsOwn) {
  for (const PhantomKind& kind : phantomKinds()) {
    const PhantomSpec spec = parsePhantomSpec("phantom:" + kind.name);
    const double extent_m = kind.name == "head" ? 0.2048 : kind.name == "lung" ? 0.336 : 0;
    EXPECT_EQ(spec.name, kind.name);
    EXPECT_EQ(spec.text, "phantom:" + kind.name);
    EXPECT_EQ(spec.size, extent_m > 0 ? Vec3i(128, 128, 64) : Vec3i(64, 64, 64)) << kind.name;
    const Vec3 spacing_m = extent_m > 0 ? Vec3(extent_m / 128, extent_m / 128, extent_m / 64) : Vec3(1e-3, 1e-3, 1e-3);
    EXPECT_LE((spec.spacing_m - spacing_m).norm(), 1e-15) << kind.name;
  }
}

// The first and the last that may be given, and what lies just beyond.
TEST(PhantomSpec, KnowsTheEndsOfItsRanges) {
  EXPECT_EQ(parsePhantomSpec("phantom:sphere?size=1x2x16384").size, Vec3i(1, 2, 16384));
  EXPECT_EQ(parsePhantomSpec("phantom:sphere?noise=0").noise, 0);
  EXPECT_EQ(parsePhantomSpec("phantom:sphere?noise=10").noise, 10);
  EXPECT_EQ(parsePhantomSpec("phantom:shell?thickness=0.1").thickness_voxels, 0.1);
  EXPECT_EQ(parsePhantomSpec("phantom:shell?thickness=1000").thickness_voxels, 1000);
  EXPECT_DOUBLE_EQ(parsePhantomSpec("phantom:sphere?spacing=0.002m").spacing_m.z(), 0.002);
  for (const auto& [keys, says] :
       {std::pair("size=2x2x16385", "size=2x2x16385 is out of range; give 1 to 16384 voxels along an axis"),
        std::pair("noise=10.1", "noise=10.1 is out of range; give 0 to 10"),
        std::pair("size=1x2", "size=\"1x2\" has 2 numbers; give one or three: 64 or 128x128x64"),
        std::pair("seed=1.5", "seed=\"1.5\" is not a number of the kind that is needed")})
    expectLoadRefusal(std::string("phantom:sphere?") + keys, says);
  for (const char* thickness : {"0.09", "1000.1"})
    expectLoadRefusal(std::string("phantom:shell?thickness=") + thickness, "is out of range; give 0.1 to 1000");
}

TEST(PhantomSpec, RefusesWhatItDoesNotKnow) {
  const auto refuses = [](const std::string& text, const std::string& reason) { expectLoadRefusal(text, reason); };
  refuses("phantom:cube", "choose one of sphere, box, spheres, knot, shell, gyroid, head, lung, random");
  refuses("phantom:", "choose one of");
  refuses("phantom:sphere?colour=red", "its keys are size, spacing, noise, seed");
  refuses("phantom:sphere?thickness=2", "its keys are size, spacing, noise, seed");
  refuses("phantom:sphere?size", "key=value");
  refuses("phantom:sphere?", "key=value");
  refuses("phantom:sphere?size=0", "1 to");
  refuses("phantom:sphere?size=100000", "1 to");
  refuses("phantom:sphere?size=64.5", "not a number");
  refuses("phantom:sphere?size=64x64", "one or three");
  refuses("phantom:sphere?size=99999999999", "not a number");
  refuses("phantom:sphere?spacing=1", "spacing=\"1\" has no unit");
  refuses("phantom:sphere?spacing=1parsec", "there is no unit \"parsec\"; write mm, um or m");
  refuses("phantom:sphere?spacing=1x1x1ell", "there is no unit \"ell\"");
  refuses("phantom:sphere?spacing=", "has no unit");
  refuses("phantom:sphere?spacing=0mm", "not positive");
  refuses("phantom:sphere?spacing=-1mm", "not positive");
  refuses("phantom:sphere?spacing=nanmm", "not positive");
  refuses("phantom:sphere?noise=nan", "out of range");
  refuses("phantom:sphere?noise=-1", "out of range");
  refuses("phantom:sphere?seed=-1", "not a number");
  refuses("phantom:shell?thickness=0", "out of range");
}

TEST(PhantomSpec, ANameOrAKeyWithATypoIsRecognised) {
  std::vector<std::string> names;
  for (const PhantomKind& kind : phantomKinds()) names.push_back(kind.name);
  forEachTypo(names, [](const std::string& name, const std::string& typed) {
    const std::string message = refusalOf([&] { static_cast<void>(parsePhantomSpec("phantom:" + typed)); });
    EXPECT_THAT(suggestedIn(message), testing::HasSubstr(name)) << message;
  });
  EXPECT_EQ(suggestedIn(refusalOf([] { static_cast<void>(parsePhantomSpec("phantom:box?spcing=8mm")); })), "spacing");
}

TEST(PhantomSpec, RefusesMoreThanMemory) {
  expectLoadRefusal("phantom:random?size=16384", "GiB", Error::Code::kOutOfMemory);
  expectLoadRefusal("phantom:sphere?size=16384", "bricks of 8 x 8 x 8", Error::Code::kOutOfMemory);
}

// What is made brick by brick is what the dense field says, to the bit; 27 is no multiple of a brick's edge.
TEST(PhantomVolume, ByBricksEqualsDense) {
  for (const PhantomKind& kind : phantomKinds()) {
    const auto phantom = makePhantom("phantom:" + kind.name + "?size=27x34x40&spacing=0.4x0.5x0.3mm");
    if (!phantom->isByPlace()) continue;
    const Volume dense =
        Volume::fromDense(phantom->size(), phantom->lattice(), phantom->densities(), makeVolume(*phantom).facts());
    const Volume bricks = makeVolume(*phantom);
    const std::vector<float> a = dense.toDense(), b = bricks.toDense();
    ASSERT_EQ(a.size(), b.size());
    EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(float)), 0) << kind.name;
    EXPECT_EQ(bricks.minimum(), dense.minimum()) << kind.name;
    EXPECT_EQ(bricks.maximum(), dense.maximum()) << kind.name;
    EXPECT_EQ(bricks.storedBricks(), dense.storedBricks()) << kind.name;
  }
}

// 1024^3 voxels are 4 GiB when dense; the ball's surface crosses about 4 pi (0.7 * 64)^2 * 1.5 bricks, times their
// thickness of a brick and a ramp: some 52,000 of 6.2 KiB, so 1 GiB holds it, and 200 MiB do not.
TEST(PhantomVolume, ALargeOneNeedsMemoryForItsSurfaceOnly) {
  constexpr const char* kLarge = "phantom:sphere?size=1024";
  const Volume volume = loadVolume(kLarge, std::size_t{1} << 30U);
  EXPECT_LT(volume.storedBricks(), 70'000U);
  for (const auto& [name, budget] :
       {std::pair(kLarge, std::size_t{200} << 20U), std::pair("phantom:random?size=1024", std::size_t{1} << 30U)}) {
    try {
      static_cast<void>(loadVolume(name, budget));
      ADD_FAILURE() << "no error: " << name;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Error::Code::kOutOfMemory);
    }
  }
}

}  // namespace phantom_test
}  // namespace palpate
