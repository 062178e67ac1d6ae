// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/hand_friction.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace palpate {
namespace {

constexpr int kTerms = 16;           // (1/2)^16 / 16! is 7e-19
constexpr double kPart = 0.5;        // of the system's own times that a part of a tick may take
constexpr int kMostParts = 100'000;  // of a tick; beyond that a system is far stiffer than any hand
constexpr int kMostCuts = 64;        // of a part: it stops and goes on at most
constexpr int kBisections = 60;

// The motion after a moment, as a power series in time: position relative to the path, y.
class Series {
 public:
  // y'' = -w2 y - d y' + a
  Series(double y, double y_slope, double w2, double d, double a) {
    terms_[0] = y;
    terms_[1] = y_slope;
    for (int n = 0; n + 2 < kTerms; ++n) {
      const auto i = static_cast<std::size_t>(n);
      const double source = n == 0 ? a : 0;
      terms_[i + 2] = (source - w2 * terms_[i] - d * (n + 1) * terms_[i + 1]) / ((n + 1) * (n + 2));
    }
  }
  [[nodiscard]] double value(double t) const noexcept {
    double sum = 0;
    for (int n = kTerms - 1; n >= 0; --n) sum = sum * t + terms_[static_cast<std::size_t>(n)];
    return sum;
  }
  [[nodiscard]] double slope(double t) const noexcept {
    double sum = 0;
    for (int n = kTerms - 1; n >= 1; --n) sum = sum * t + n * terms_[static_cast<std::size_t>(n)];
    return sum;
  }

 private:
  std::array<double, kTerms> terms_{};
};

class Axis {
 public:
  Axis(const HandParameters& p, FrictionAxis state, PathAxis path, double force_N)
      : mass_kg_(p.hand_mass_kg + p.device_mass_kg),
        stiffness_(p.hand_stiffness_N_per_m),
        hand_damping_(p.hand_damping_Ns_per_m),
        device_damping_(p.device_damping_Ns_per_m),
        friction_N_(p.device_friction_N),
        state_(state),
        path_(path),
        force_N_(force_N) {}

  [[nodiscard]] FrictionAxis after(double tick_s) noexcept {
    const double damping = (hand_damping_ + device_damping_) / mass_kg_;
    const double quickest_per_s = std::max({std::sqrt(stiffness_ / mass_kg_), damping, 1e-30});
    const double parts = std::clamp(std::ceil(tick_s * quickest_per_s / kPart), 1.0, static_cast<double>(kMostParts));
    for (int part = 0; part < static_cast<int>(parts); ++part) pass(tick_s / parts);
    return state_;
  }

 private:
  // What acts besides friction on the device at rest.
  [[nodiscard]] double pull_N() const noexcept {
    return stiffness_ * (path_.start_m - state_.position_m) + hand_damping_ * path_.slope_m_per_s + force_N_;
  }

  void pass(double time_s) noexcept {
    for (int cut = 0; cut < kMostCuts && time_s > 0; ++cut) {
      double way = state_.velocity_m_per_s;
      if (way == 0) {
        const double held_s = heldFor(time_s);
        path_.start_m += path_.slope_m_per_s * held_s;
        time_s -= held_s;
        if (!(time_s > 0)) return;
        way = pull_N() != 0 ? pull_N() : path_.slope_m_per_s;  // as it breaks loose, the pull is just friction
      }
      time_s -= slide(std::copysign(1.0, way), time_s);
    }
  }

  // How long friction holds the device at rest. The pull grows with the path.
  [[nodiscard]] double heldFor(double time_s) const noexcept {
    const double pull = pull_N();
    if (std::abs(pull) > friction_N_) return 0;
    const double growth_N_per_s = stiffness_ * path_.slope_m_per_s;
    if (growth_N_per_s == 0) return time_s;
    return std::min(time_s, (std::copysign(friction_N_, growth_N_per_s) - pull) / growth_N_per_s);
  }

  // Moves one way until it stops or the time is over; gives the time that passed.
  [[nodiscard]] double slide(double sign, double time_s) noexcept {
    const double damping = (hand_damping_ + device_damping_) / mass_kg_;
    const double constant = (force_N_ - sign * friction_N_ - device_damping_ * path_.slope_m_per_s) / mass_kg_;
    const Series y(state_.position_m - path_.start_m, state_.velocity_m_per_s - path_.slope_m_per_s,
                   stiffness_ / mass_kg_, damping, constant);
    const auto velocity = [&](double t) { return y.slope(t) + path_.slope_m_per_s; };
    double passed_s = time_s;
    const bool stops = sign * velocity(time_s) < 0;
    if (stops) {
      double before = 0;
      for (int i = 0; i < kBisections; ++i) {
        const double middle = 0.5 * (before + passed_s);
        (sign * velocity(middle) >= 0 ? before : passed_s) = middle;
      }
    }
    path_.start_m += path_.slope_m_per_s * passed_s;
    state_ = {y.value(passed_s) + path_.start_m, stops ? 0 : velocity(passed_s)};
    return passed_s;
  }

  double mass_kg_, stiffness_, hand_damping_, device_damping_, friction_N_;
  FrictionAxis state_;
  PathAxis path_;  // from now on
  double force_N_;
};

}  // namespace

FrictionAxis stepWithFriction(const HandParameters& parameters, FrictionAxis state, PathAxis path, double force_N,
                              double tick_s) noexcept {
  return Axis(parameters, state, path, force_N).after(tick_s);
}

}  // namespace palpate
