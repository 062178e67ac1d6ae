// SPDX-License-Identifier: Apache-2.0
// servo/loop/velocity.hpp: the servo's velocity estimate, chosen by name: `filter` (velocity_filter.hpp) or `foaw`
// (foaw.hpp).
//
// A new estimate is a file here, an alternative of the variant and a row in velocity.cpp. The estimate is always
// finite: if the difference of two positions is not finite, it starts again from rest.
// Frame W: world [m, m/s]. Thread: the servo's; the constructor and velocityEstimates() before the loop starts. Cost:
// that of the chosen estimate; no heap after construction.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "base/vec.hpp"
#include "servo/loop/foaw.hpp"
#include "servo/loop/velocity_filter.hpp"

namespace palpate {

struct VelocityParameters {
  std::string name = "filter";                   // a row of velocityEstimates()
  double cutoff_hz = 200;                        // of filter; 0: no low-pass [Hz]
  std::optional<double> noise_m = std::nullopt;  // of foaw; empty: the device's resolution in a loop, else 0 [m]
  int window_ticks = 16;                         // of foaw: 1 to Foaw::kMostTicks [tick]
};

struct VelocityEntry {
  std::string_view name;
  std::string_view description;  // one line
};

// The first is the default.
[[nodiscard]] std::span<const VelocityEntry> velocityEstimates() noexcept;

class VelocityEstimate {
 public:
  // Throws Error(kBadInput) on an unknown name (the message names the known ones), on a cutoff that is not finite, a
  // noise bound that is negative or not finite, and a window outside 1 to Foaw::kMostTicks.
  VelocityEstimate(const VelocityParameters& parameters, double rate_hz);

  // Starts at rest at `position_W` [m].
  void reset(const Vec3& position_W) noexcept {
    std::visit([&](auto& estimate) { estimate.reset(position_W); }, estimate_);
    velocity_W_.setZero();
  }

  // `ticks`: grid periods since the last position, at least 1.
  void update(const Vec3& position_W, int ticks) noexcept {
    if (auto* filter = std::get_if<VelocityFilter>(&estimate_)) {
      velocity_W_ = filter->update(position_W, ticks);
    } else {
      velocity_W_ = std::get_if<Foaw>(&estimate_)->update(position_W, ticks);
    }
    if (!velocity_W_.allFinite()) reset(position_W);
  }

  // The velocity at the newest position [m/s].
  [[nodiscard]] const Vec3& value() const noexcept { return velocity_W_; }

 private:
  std::variant<VelocityFilter, Foaw> estimate_;
  Vec3 velocity_W_ = Vec3::Zero();
};

}  // namespace palpate
