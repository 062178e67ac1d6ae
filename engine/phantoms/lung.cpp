// SPDX-License-Identifier: Apache-2.0
// A CT-like chest: wall, two lungs, a tree of vessels in each, a spine. The body runs through the lattice along z.
//
// The declared surface (isovalue -400) separates soft tissue from air: (body - lungs) + vessels. Its distance is exact
// near smooth parts of the surface. Inside the tissue where a vessel leaves the wall, or where two branches join, its
// magnitude is only a lower bound. The zero set is exact everywhere.
#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/phantoms/kinds.hpp"
#include "engine/phantoms/solid.hpp"

namespace palpate {
namespace {

constexpr double kLungAir = -850;
constexpr double kIsovalue = -400;
constexpr double kSpine = 700;
constexpr double kLungHalfCube_m = 0.168;  // the natural lattice's half edge [m]

// Natural lengths [m].
constexpr double kBodyX = 0.150;
constexpr double kBodyY = 0.105;
const Vec3 kLungCentre = {0.070, -0.005, 0};  // the left one; the right one mirrors it
const Vec3 kLungAxes = {0.055, 0.075, 0.125};
const Vec3 kSpineCentre = {0, 0.075, 0};
constexpr double kSpineX = 0.018;
constexpr double kSpineY = 0.016;

struct Vessel {
  Vec3 from_W;
  Vec3 to_W;
  double radius_m;
};

constexpr int kGenerations = 5;
constexpr double kLengthRatio = 0.8;
constexpr double kRadiusRatio = 0.75;

// Each vessel parts in two, by 40 degrees to either side, in planes that alternate.
void grow(std::vector<Vessel>& tree, const Vec3& from_W, const Vec3& direction, const Vec3& side, double length_m,
          double radius_m, int generation) {
  if (generation == kGenerations) return;
  const Vec3 to_W = from_W + length_m * direction;
  tree.push_back({from_W, to_W, radius_m});
  const double cos40 = 0.766044443118978;
  const double sin40 = 0.6427876096865393;
  for (const double sign : {-1.0, 1.0}) {
    const Vec3 turned = (cos40 * direction + sign * sin40 * side).normalized();
    grow(tree, to_W, turned, turned.cross(side).normalized(), length_m * kLengthRatio, radius_m * kRadiusRatio,
         generation + 1);
  }
}

class Lung : public Phantom {
 public:
  explicit Lung(const PhantomSpec& spec)
      : Phantom(spec, {kIsovalue, kAir, kSoft, kSlopePerVoxel / std::cbrt(spec.spacing_m.prod())}),
        scale_(spec.size.cast<double>().cwiseProduct(spec.spacing_m).minCoeff() / 2 / kLungHalfCube_m) {
    for (const double sign : {-1.0, 1.0}) {
      grow(vessels_, Vec3(sign * 0.020, 0, 0) * scale_, Vec3(sign, 0, 0), Vec3::UnitZ(), 0.035 * scale_, 0.008 * scale_,
           0);
    }
  }

  [[nodiscard]] SurfaceOffset offset(const Vec3& p_W) const override {
    SurfaceOffset tissue = subtract(bodyOffset(p_W), lungsOffset(p_W));
    for (const Vessel& vessel : vessels_) {
      tissue = unite(tissue, capsuleOffset(p_W, vessel.from_W, vessel.to_W, vessel.radius_m));
    }
    return tissue;
  }

  [[nodiscard]] double density(const Vec3& p_W) const override {
    const double lowest = bodyOffset(p_W).distance_m > 0 ? kAir : kLungAir;
    const double spine = std::clamp(-spineDistance_m(p_W) * profile().slope_per_m, 0.0, kSpine - kSoft);
    return std::clamp(isovalue() - profile().slope_per_m * signedDistance_m(p_W), lowest, kSoft) + spine;
  }

 protected:
  [[nodiscard]] double constantRadius_m(const Vec3& p_W) const override {
    const double slope = profile().slope_per_m;
    return std::min(Phantom::constantRadius_m(p_W), beyondRamp_m(spineDistance_m(p_W), (kSpine - kSoft) / slope, 0));
  }

 private:
  [[nodiscard]] SurfaceOffset bodyOffset(const Vec3& p_W) const {
    return ellipticCylinderOffset(p_W, Vec3::Zero(), kBodyX * scale_, kBodyY * scale_);
  }
  [[nodiscard]] SurfaceOffset lungsOffset(const Vec3& p_W) const {
    const Vec3 left_W = kLungCentre * scale_;
    const Vec3 right_W(-left_W.x(), left_W.y(), left_W.z());
    return unite(ellipsoidOffset(p_W, left_W, kLungAxes * scale_), ellipsoidOffset(p_W, right_W, kLungAxes * scale_));
  }
  [[nodiscard]] double spineDistance_m(const Vec3& p_W) const {
    return ellipticCylinderOffset(p_W, kSpineCentre * scale_, kSpineX * scale_, kSpineY * scale_).distance_m;
  }

  double scale_;  // of the lattice to the natural one [-]
  std::vector<Vessel> vessels_;
};

}  // namespace

std::unique_ptr<Phantom> makeLung(const PhantomSpec& spec) {
  return std::make_unique<Lung>(spec);
}

}  // namespace palpate
