// SPDX-License-Identifier: Apache-2.0
// The simple phantoms: sphere, box, three spheres, shell. Their distances are exact everywhere. (Those of overlapping
// spheres would not be exact inside, but these three do not overlap.)
#include <algorithm>
#include <array>

#include "engine/phantoms/kinds.hpp"
#include "engine/phantoms/solid.hpp"

namespace palpate {

SurfaceOffset sphereOffset(const Vec3& p_W, const Vec3& centre_W, double radius_m) {
  const Vec3 arm = p_W - centre_W;
  const double length_m = arm.norm();
  return {length_m - radius_m, length_m > 0 ? Vec3(arm / length_m) : Vec3::UnitZ()};
}

SurfaceOffset boxOffset(const Vec3& p_W, const Vec3& half_edges_m) {
  const Vec3 beyond = p_W.cwiseAbs() - half_edges_m;
  const Vec3 sign = p_W.unaryExpr([](double x) { return x < 0 ? -1.0 : 1.0; });
  int axis = 0;
  const double farthest = beyond.maxCoeff(&axis);
  if (farthest <= 0) return {farthest, Vec3::Unit(axis) * sign[axis]};
  const Vec3 outside = beyond.cwiseMax(0);
  return {outside.norm(), outside.normalized().cwiseProduct(sign)};
}

SurfaceOffset capsuleOffset(const Vec3& p_W, const Vec3& from_W, const Vec3& to_W, double radius_m) {
  const Vec3 axis = to_W - from_W;
  const double along = std::clamp((p_W - from_W).dot(axis) / axis.squaredNorm(), 0.0, 1.0);
  return sphereOffset(p_W, from_W + along * axis, radius_m);
}

Phantom::Profile simpleProfile(const PhantomSpec& spec) {
  constexpr double kRampVoxels = 3;
  Phantom::Profile profile;
  profile.slope_per_m = profile.high / (kRampVoxels * spec.spacing_m.maxCoeff());
  return profile;
}

double halfExtent_m(const PhantomSpec& spec) {
  return (spec.size - Vec3i::Ones()).cast<double>().cwiseProduct(spec.spacing_m).minCoeff() / 2;
}

namespace {

class Sphere : public Phantom {
 public:
  explicit Sphere(const PhantomSpec& spec) : Phantom(spec, simpleProfile(spec)), radius_m_(0.7 * halfExtent_m(spec)) {}
  [[nodiscard]] SurfaceOffset offset(const Vec3& p_W) const override {
    return sphereOffset(p_W, Vec3::Zero(), radius_m_);
  }

 private:
  double radius_m_;
};

// Sharp edges: outside them the nearest surface point is on the edge, so the distance is rounded there, as it must be.
class Box : public Phantom {
 public:
  explicit Box(const PhantomSpec& spec)
      : Phantom(spec, simpleProfile(spec)), half_edges_m_(-0.6 * lattice().origin_W) {}
  [[nodiscard]] SurfaceOffset offset(const Vec3& p_W) const override { return boxOffset(p_W, half_edges_m_); }

 private:
  Vec3 half_edges_m_;
};

// Wall between two concentric spheres; the distance is to the nearer of its two faces.
class Shell : public Phantom {
 public:
  explicit Shell(const PhantomSpec& spec)
      : Phantom(spec, simpleProfile(spec)),
        radius_m_(0.7 * halfExtent_m(spec)),
        half_wall_m_(spec.thickness_voxels * spec.spacing_m.maxCoeff() / 2) {}
  [[nodiscard]] SurfaceOffset offset(const Vec3& p_W) const override {
    return subtract(sphereOffset(p_W, Vec3::Zero(), radius_m_ + half_wall_m_),
                    sphereOffset(p_W, Vec3::Zero(), radius_m_ - half_wall_m_));
  }

 private:
  double radius_m_;  // of the wall's middle
  double half_wall_m_;
};

// Three spheres that do not touch; all share the isovalue, each has its own density inside.
class Spheres : public Phantom {
 public:
  explicit Spheres(const PhantomSpec& spec) : Phantom(spec, withHighest(simpleProfile(spec))) {
    const double r_m = halfExtent_m(spec);
    balls_ = {Ball{Vec3(-0.45, -0.35, -0.20) * r_m, 0.38 * r_m, 600},
              Ball{Vec3(0.50, -0.25, 0.25) * r_m, 0.28 * r_m, 1000},
              Ball{Vec3(0.00, 0.50, 0.10) * r_m, 0.25 * r_m, kHighest}};
  }

  [[nodiscard]] SurfaceOffset offset(const Vec3& p_W) const override { return ballOffset(nearestBall(p_W), p_W); }

  [[nodiscard]] double density(const Vec3& p_W) const override {
    const Ball& ball = nearestBall(p_W);
    return std::clamp(isovalue() - profile().slope_per_m * ballOffset(ball, p_W).distance_m, profile().low,
                      ball.density);
  }

 private:
  struct Ball {
    Vec3 centre_W;
    double radius_m;
    double density;
  };
  static constexpr double kHighest = 1400;

  static Profile withHighest(Profile profile) {
    profile.high = kHighest;
    return profile;
  }
  static SurfaceOffset ballOffset(const Ball& ball, const Vec3& p_W) {
    return sphereOffset(p_W, ball.centre_W, ball.radius_m);
  }
  [[nodiscard]] const Ball& nearestBall(const Vec3& p_W) const {
    return *std::min_element(balls_.begin(), balls_.end(), [&](const Ball& a, const Ball& b) {
      return ballOffset(a, p_W).distance_m < ballOffset(b, p_W).distance_m;
    });
  }

  std::array<Ball, 3> balls_;
};

}  // namespace

std::unique_ptr<Phantom> makeSphere(const PhantomSpec& spec) {
  return std::make_unique<Sphere>(spec);
}
std::unique_ptr<Phantom> makeBox(const PhantomSpec& spec) {
  return std::make_unique<Box>(spec);
}
std::unique_ptr<Phantom> makeSpheres(const PhantomSpec& spec) {
  return std::make_unique<Spheres>(spec);
}
std::unique_ptr<Phantom> makeShell(const PhantomSpec& spec) {
  return std::make_unique<Shell>(spec);
}

}  // namespace palpate
