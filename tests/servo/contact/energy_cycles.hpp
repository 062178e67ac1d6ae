// SPDX-License-Identifier: Apache-2.0
// tests/servo/contact/energy_cycles.hpp: closed paths of a tool in and out of a body, and the energy that it gets on
// them.
//
// A body is a surface with an exact distance in a volume of any lattice, and a map from surface coordinates and depth
// to the tool's place. Below the surface the material differs from place to place.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "servo/algorithms/registry.hpp"
#include "servo/contact/effects.hpp"
#include "support/analytic_surface.hpp"

namespace palpate {

constexpr double kEnergyStiffness = 500;  // [N/m]

class Dice {
 public:
  explicit Dice(std::uint32_t seed) : engine_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_()) / 4294967295.0);
  }
  double spread(double low, double high) { return low * std::pow(high / low, between(0, 1)); }  // even in the logarithm
  int below(int count) { return static_cast<int>(engine_() % static_cast<std::uint32_t>(count)); }
  bool coin() { return below(2) == 1; }

 private:
  std::mt19937 engine_;
};

// Millimetre cubes along the world's axes, or 0.5 x 0.5 mm x `slice_m` turned, or the same left-handed.
inline Lattice energyLattice(int kind, double slice_m) {
  Lattice lattice;
  if (kind > 0) {
    lattice.spacing_m = Vec3(0.5e-3, 0.5e-3, slice_m);
    lattice.R_WL = (Eigen::AngleAxisd(0.7, Vec3(0.3, -0.5, 0.8).normalized())).toRotationMatrix();
  }
  if (kind == 2) lattice.R_WL.col(1) *= -1;
  return lattice;
}

struct EnergyBody {
  std::string name;
  AnalyticSurface surface;
  std::function<Vec3(double a, double b, double depth_m)> at;  // a and b: metres along the surface, about 0
  double deepest_m = 4e-3;
  double slice_m = 3e-3;

  static EnergyBody plane(Dice& dice) {
    const Vec3 n = Vec3(dice.between(-1, 1), dice.between(-1, 1), dice.between(-1, 1)).normalized();
    const Vec3 u = n.cross(Vec3::UnitX()).normalized(), v = n.cross(u);
    return {"plane", planeSurface(0.3e-3 * n, n),
            [=](double a, double b, double depth_m) { return Vec3((0.3e-3 - depth_m) * n + a * u + b * v); }};
  }
  // The outside of a ball of 18 mm, or the inside of a hollow ball of 17 mm.
  static EnergyBody ball(Dice& dice, bool hollow) {
    const double radius_m = hollow ? 17e-3 : 18e-3, out = hollow ? -1 : 1;
    const Mat3 R = Eigen::AngleAxisd(dice.between(0, 6), Vec3(dice.between(-1, 1), 1, dice.between(-1, 1)).normalized())
                       .toRotationMatrix();
    const AnalyticSurface outside = ballSurface(Vec3::Zero(), radius_m);
    return {hollow ? "hollow ball" : "ball",
            {[=](const Vec3& x) { return out * outside.distance_m(x); },
             [=](const Vec3& x) { return Vec3(out * outside.normal(x)); }},
            [=](double a, double b, double depth_m) {
              return Vec3(R * Vec3(a, b, radius_m).normalized() * (radius_m - out * depth_m));
            },
            3e-3};
  }
  // A tube of 4 mm around a torus knot.
  static EnergyBody knot(Dice& dice) {
    const TorusKnot knot(Vec3::Zero(), 21e-3, 4e-3);
    const double t = dice.between(0, 6), angle = dice.between(0, 6);
    return {"knot", knot.surface(),
            [=](double a, double b, double depth_m) { return knot.below(t + a / 25e-3, angle + b / 4e-3, depth_m); },
            1.5e-3, 1.5e-3};
  }
};

// All samples of the body, as one window. The density is steepness times the depth. Deeper than two voxels it also
// varies from place to place, by as much as 2 mm of depth would change it, so that a stiffness table has an effect.
// Surface and normal do not depend on that: interpolation and central differences reach 2 voxels.
class EnergyVolume {
 public:
  static constexpr double kSteepness = 1e5;  // [density/m]
  static constexpr double kSide_m = 48e-3;

  EnergyVolume(const EnergyBody& body, int lattice_kind, double noise_m, std::uint32_t seed) {
    AnalyticVolume& volume = volume_;
    volume.lattice = energyLattice(lattice_kind, body.slice_m);
    volume.size = Vec3::Constant(kSide_m).cwiseQuotient(volume.lattice.spacing_m).array().round().cast<int>() + 1;
    volume.lattice.origin_W = -volume.lattice.R_WL * Vec3::Constant(0.5 * kSide_m);
    Dice dice(seed);
    const Vec3 wave = 2 * std::numbers::pi / 9e-3 * Vec3(dice.between(-1, 1), dice.between(-1, 1), 1).normalized();
    std::vector<double> values;
    const Vec3i size = volume.size;
    for (int k = 0; k < size.z(); ++k) {
      for (int j = 0; j < size.y(); ++j) {
        for (int i = 0; i < size.x(); ++i) {
          const Vec3 p = volume.lattice.toWorld(Vec3(i, j, k));
          const double inward_m = -body.surface.distance_m(p) + noise_m * dice.between(-1, 1);
          values.push_back(kSteepness * (inward_m + materialAt(body, p, inward_m, wave)));
        }
      }
    }
    volume = withSamples(volume, std::move(values));
    volume.hold(held_, Vec3i::Zero(), size);
  }

  [[nodiscard]] const SampleWindow& window() const { return held_.window; }
  [[nodiscard]] double voxel() const { return volume_.lattice.smallestSpacing(); }

 private:
  [[nodiscard]] double materialAt(const EnergyBody& body, const Vec3& p_W, double inward_m, const Vec3& wave) const {
    if (inward_m < 2 * voxel()) return 0;
    const Vec3 normal_L = volume_.lattice.R_WL.transpose() * body.surface.normal(p_W);
    const double below_m = 2 * normal_L.cwiseAbs().dot(volume_.lattice.spacing_m);
    return 2e-3 * std::clamp((inward_m - below_m) / 1e-3, 0.0, 1.0) * std::sin(wave.dot(p_W));
  }

  AnalyticVolume volume_;
  HeldWindow held_;
};

struct EnergyWay {
  std::vector<Vec3> hips;
  std::vector<double> depths_m;
  double deepest_m = 0;
};

// Press, slide with varying depth, withdraw. A slide is up to 12 mm long; the last may lead back to the first place. At
// most `step_m` a tick.
inline EnergyWay randomCycle(const EnergyBody& body, Dice& dice, double step_m) {
  struct Point {
    double a, b, depth;
  };
  const auto depth = [&] { return dice.spread(0.1, 1) * body.deepest_m; };
  Point at{dice.between(-3e-3, 3e-3), dice.between(-3e-3, 3e-3), -0.2e-3};
  std::vector<Point> stations = {at};
  stations.push_back({at.a, at.b, depth()});
  const int slides = 1 + dice.below(4);
  for (int i = 0; i < slides; ++i) {
    stations.push_back({dice.between(-6e-3, 6e-3), dice.between(-6e-3, 6e-3), depth()});
  }
  if (dice.coin()) stations.push_back(stations[1]);
  stations.push_back({stations.back().a, stations.back().b, -0.2e-3});
  EnergyWay way;
  for (std::size_t s = 0; s + 1 < stations.size(); ++s) {
    const Point& from = stations[s];
    const Point& to = stations[s + 1];
    const double length_m = std::hypot(to.a - from.a, to.b - from.b, to.depth - from.depth);
    const int ticks = static_cast<int>(std::ceil(length_m / step_m));
    for (int i = s == 0 ? 0 : 1; i <= ticks; ++i) {
      const double share = static_cast<double>(i) / ticks;
      const double d = from.depth + (to.depth - from.depth) * share;
      way.hips.push_back(body.at(from.a + (to.a - from.a) * share, from.b + (to.b - from.b) * share, d));
      way.depths_m.push_back(d);
      way.deepest_m = std::max(way.deepest_m, d);
    }
  }
  return way;
}

struct Cycle {
  double given_J = 0;         // the most that the tool had been given beyond what it put in, anywhere on the path
  double stored_J = 0;        // the most that a spring of this force stores at this depth
  double largest_step_N = 0;  // of the force from one tick to the next
  double largest_N = 0;
  int lost = 0;  // contacts that ended before the path did
};

// The work uses the mean of a tick's two forces, so it is the work of the field. Holding a force over a tick adds
// energy too. Every sampled wall does that, with effects or without, so it does not count here.
inline Cycle energyOf(const EnergyVolume& volume, const EnergyWay& way, const EffectParameters& effects, int n,
                      double rate_hz) {
  AlgorithmSetup setup;
  setup.parameters.stiffness_N_per_m = kEnergyStiffness;
  setup.parameters.damping_Ns_per_m = 0;
  setup.parameters.plane_renewal_ticks = n;
  setup.parameters.rate_hz = rate_hz;
  setup.effects = makeContactEffects(effects, kEnergyStiffness, rate_hz);
  const auto algorithm = makeAlgorithm("hri", std::move(setup));
  algorithm->reset(way.hips.front());
  Cycle cycle;
  double account_J = 0;
  Vec3 last_hip = way.hips.front(), last_force = Vec3::Zero();
  bool was_in_contact = false;
  for (std::size_t i = 0; i < way.hips.size(); ++i) {
    const Vec3& hip = way.hips[i];
    TickOutput out;
    algorithm->tick({hip, (hip - last_hip) * rate_hz, &volume.window()}, out);
    account_J -= 0.5 * (out.force_W + last_force).dot(hip - last_hip);
    cycle.given_J = std::max(cycle.given_J, -account_J);
    cycle.stored_J = std::max(cycle.stored_J, 0.5 * out.normal_W.dot(out.force_W) * way.depths_m[i]);
    cycle.largest_step_N = std::max(cycle.largest_step_N, (out.force_W - last_force).norm());
    cycle.largest_N = std::max(cycle.largest_N, out.force_W.norm());
    cycle.lost += was_in_contact && !out.in_contact && way.depths_m[i] > 0.2 * way.deepest_m ? 1 : 0;
    was_in_contact = out.in_contact;
    last_hip = hip;
    last_force = out.force_W;
  }
  return cycle;
}

}  // namespace palpate
