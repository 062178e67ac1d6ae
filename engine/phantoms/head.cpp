// SPDX-License-Identifier: Apache-2.0
// A CT-like head: skin, skull with a drilled hole, facial bone with two air-filled sinuses, brain with ventricles.
//
// The declared surface (isovalue 300) is bone: (skull shell + facial bone) - hole - sinuses. Its distance is exact near
// smooth parts of the surface. Where two bodies meet, its magnitude is only a lower bound: outside near the rims of the
// hole, inside the bone where the face joins the skull. The zero set is exact everywhere. The skin lies at -300 as long
// as four voxels (geometric mean of the spacing) are less than the scalp's 9 mm.
#include <algorithm>
#include <array>
#include <cmath>

#include "engine/phantoms/kinds.hpp"
#include "engine/phantoms/solid.hpp"

namespace palpate {
namespace {

constexpr double kSkin = -300;
constexpr double kBrain = 30;
constexpr double kVentricle = 8;
constexpr double kBone = 1000;
constexpr double kBoneIsovalue = 300;
constexpr double kHeadHalfCube_m = 0.1024;  // the natural lattice's half edge [m]

struct Ellipsoid {
  Vec3 centre;     // [m] at natural size
  Vec3 semi_axes;  // [m]
};

const Ellipsoid kHeadBody = {{0, 0, 0}, {0.075, 0.092, 0.088}};
const Ellipsoid kSkullOuter = {{0, 0, 0}, {0.066, 0.083, 0.079}};
const Ellipsoid kSkullInner = {{0, 0, 0}, {0.058, 0.075, 0.071}};
const Ellipsoid kBrainBody = {{0, 0, 0}, {0.054, 0.071, 0.067}};
const Ellipsoid kFace = {{0, -0.052, -0.038}, {0.028, 0.020, 0.024}};  // anterior is -y
const std::array<Ellipsoid, 2> kSinuses = {
    {{{0.013, -0.054, -0.038}, {0.009, 0.011, 0.012}}, {{-0.013, -0.054, -0.038}, {0.009, 0.011, 0.012}}}};
const std::array<Ellipsoid, 2> kVentricles = {
    {{{0.010, 0, 0.010}, {0.006, 0.022, 0.010}}, {{-0.010, 0, 0.010}, {0.006, 0.022, 0.010}}}};
const Vec3 kHoleFrom = {0.030, 0, 0.040};  // the drill's axis, through the left parietal bone
const Vec3 kHoleTo = {0.060, 0, 0.080};
constexpr double kHoleRadius = 0.009;

class Head : public Phantom {
 public:
  explicit Head(const PhantomSpec& spec)
      : Phantom(spec, boneProfile(spec)), scale_(halfExtentOfVoxels_m(spec) / kHeadHalfCube_m) {}

  [[nodiscard]] SurfaceOffset offset(const Vec3& p_W) const override {
    const SurfaceOffset skull = subtract(at(kSkullOuter, p_W), at(kSkullInner, p_W));
    const SurfaceOffset bone = unite(skull, at(kFace, p_W));
    const SurfaceOffset hole = capsuleOffset(p_W, kHoleFrom * scale_, kHoleTo * scale_, kHoleRadius * scale_);
    return subtract(subtract(bone, hole), pair(kSinuses, p_W));
  }

  [[nodiscard]] double density(const Vec3& p_W) const override {
    const double slope = profile().slope_per_m;
    const double bone = std::clamp(kBoneIsovalue - slope * signedDistance_m(p_W), kAir, kBone);
    const double soft = std::clamp(kSkin - slope * skinDistance_m(p_W), kAir, softest(p_W));
    return std::max(bone, soft);
  }

 protected:
  [[nodiscard]] double constantRadius_m(const Vec3& p_W) const override {
    const double slope = profile().slope_per_m;
    const double one_m = tissueRamp_m();
    return std::min(
        {beyondRamp_m(signedDistance_m(p_W), (kBone - kBoneIsovalue) / slope, (kBoneIsovalue - kAir) / slope),
         beyondRamp_m(skinDistance_m(p_W), (kSoft - kSkin) / slope, (kSkin - kAir) / slope),
         beyondRamp_m(at(kBrainBody, p_W).distance_m, one_m, 0),
         beyondRamp_m(pair(kVentricles, p_W).distance_m, one_m, 0)});
  }

 private:
  static double meanSpacing_m(const PhantomSpec& spec) { return std::cbrt(spec.spacing_m.prod()); }
  static double halfExtentOfVoxels_m(const PhantomSpec& spec) {
    return spec.size.cast<double>().cwiseProduct(spec.spacing_m).minCoeff() / 2;
  }
  static Profile boneProfile(const PhantomSpec& spec) {
    return {kBoneIsovalue, kAir, kBone, kSlopePerVoxel / meanSpacing_m(spec)};
  }

  [[nodiscard]] SurfaceOffset at(const Ellipsoid& body, const Vec3& p_W) const {
    return ellipsoidOffset(p_W, body.centre * scale_, body.semi_axes * scale_);
  }
  [[nodiscard]] SurfaceOffset pair(const std::array<Ellipsoid, 2>& bodies, const Vec3& p_W) const {
    return unite(at(bodies[0], p_W), at(bodies[1], p_W));
  }
  [[nodiscard]] double skinDistance_m(const Vec3& p_W) const {
    return subtract(at(kHeadBody, p_W), pair(kSinuses, p_W)).distance_m;
  }

  // Brain and ventricles are a little darker than the scalp; each boundary is a ramp of one voxel.
  [[nodiscard]] double tissueRamp_m() const { return meanSpacing_m(spec()); }
  [[nodiscard]] double softest(const Vec3& p_W) const {
    const auto depth = [&](double distance_m) { return std::clamp(-distance_m / tissueRamp_m(), 0.0, 1.0); };
    return kSoft - (kSoft - kBrain) * depth(at(kBrainBody, p_W).distance_m) -
           (kBrain - kVentricle) * depth(pair(kVentricles, p_W).distance_m);
  }

  double scale_;  // of the lattice to the natural one [-]
};

}  // namespace

std::unique_ptr<Phantom> makeHead(const PhantomSpec& spec) {
  return std::make_unique<Head>(spec);
}

}  // namespace palpate
