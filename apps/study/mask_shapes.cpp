// SPDX-License-Identifier: Apache-2.0
#include "apps/study/mask_shapes.hpp"

#include <cmath>
#include <utility>

#include "apps/bench/random.hpp"

namespace palpate {
namespace {

PhantomSpec specOf(const MaskShape& shape) {
  PhantomSpec spec;
  spec.text = "mask of a " + shape.name;
  spec.size = shape.size;
  spec.spacing_m = shape.spacing_m;
  return spec;
}

class Mask : public Phantom {
 public:
  Mask(const MaskShape& shape, std::uint64_t seed)
      : Phantom(specOf(shape), {.isovalue = kMaskIsovalue, .low = 0, .high = 1, .slope_per_m = 0}),
        body_(makePhantom(shape.body)) {
    Random random(seed);
    // Gathered from a direction and an angle: any turn, though not each as likely as the others.
    R_WB_ = Eigen::AngleAxisd(random.uniform(0.3, 1.2), random.direction());
    for (int axis = 0; axis < 3; ++axis) shift_W_[axis] = random.uniform(-0.5, 0.5) * shape.spacing_m[axis];
  }

  [[nodiscard]] SurfaceOffset offset(const Vec3& p_W) const override {
    const SurfaceOffset in_body = body_->offset(R_WB_.transpose() * (p_W - shift_W_));
    return {in_body.distance_m, R_WB_ * in_body.normal};
  }
  [[nodiscard]] double density(const Vec3& p_W) const override { return signedDistance_m(p_W) < 0 ? 1 : 0; }

 protected:
  [[nodiscard]] double constantRadius_m(const Vec3& p_W) const override { return std::abs(signedDistance_m(p_W)); }

 private:
  std::unique_ptr<Phantom> body_;
  Mat3 R_WB_ = Mat3::Identity();
  Vec3 shift_W_ = Vec3::Zero();
};

}  // namespace

const std::vector<MaskShape>& maskShapes() {
  const Vec3 slices_m(1e-3, 1e-3, 3e-3);
  static const std::vector<MaskShape> kShapes = {
      // A phantom's ball has 0.35 (size - 1) voxels.
      {.name = "ball of 6 voxels", .body = "phantom:sphere?size=18", .size = Vec3i::Constant(28)},
      {.name = "ball of 10 voxels", .body = "phantom:sphere?size=30", .size = Vec3i::Constant(36)},
      {.name = "ball of 20 voxels", .body = "phantom:sphere?size=58", .size = Vec3i::Constant(56)},
      {.name = "ball of 40 voxels", .body = "phantom:sphere?size=115", .size = Vec3i::Constant(96)},
      // Its half edges are 0.3 (size - 1) voxels.
      {.name = "edges of a box of 24 voxels", .body = "phantom:box?size=41", .size = Vec3i::Constant(60)},
      {.name = "tube of 6 voxels", .body = "phantom:knot?size=96", .size = Vec3i::Constant(112)},
      {.name = "wall of 2.5 voxels",
       .body = "phantom:shell?size=58&thickness=2.5",
       .size = Vec3i::Constant(60),
       .depth_mm = 1},
      {.name = "ball of 20 mm, slices of 3 mm",
       .body = "phantom:sphere?size=58",
       .size = Vec3i(56, 56, 20),
       .spacing_m = slices_m,
       .depth_mm = 2},
      {.name = "edges of a box of 24 mm, slices of 3 mm",
       .body = "phantom:box?size=41",
       .size = Vec3i(60, 60, 22),
       .spacing_m = slices_m,
       .depth_mm = 2}};
  return kShapes;
}

std::unique_ptr<Phantom> makeMask(const MaskShape& shape, std::uint64_t seed) {
  return std::make_unique<Mask>(shape, seed);
}

}  // namespace palpate
