// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/velocity.hpp"

#include <array>
#include <cmath>

#include "base/error.hpp"
#include "base/formatted.hpp"

namespace palpate {
namespace {

using Estimate = std::variant<VelocityFilter, Foaw>;
using Maker = Estimate (*)(const VelocityParameters&, double rate_hz);

constexpr std::array<VelocityEntry, 2> kEntries = {{
    {"filter", "backward difference and a first-order low-pass"},
    {"foaw", "first-order adaptive windowing: a long window in slow motion, a short one in fast"},
}};
constexpr std::array<Maker, kEntries.size()> kMakers = {
    [](const VelocityParameters& p, double rate_hz) -> Estimate { return VelocityFilter(p.cutoff_hz, rate_hz); },
    [](const VelocityParameters& p, double rate_hz) -> Estimate {
      return Foaw(p.noise_m.value_or(0), p.window_ticks, rate_hz);
    },
};

Estimate make(const VelocityParameters& p, double rate_hz) {
  checkSetting(true, "velocity cutoff", p.cutoff_hz, "give Hz, or 0 for none");
  const double noise_m = p.noise_m.value_or(0);
  checkSetting(noise_m >= 0, "velocity noise bound", noise_m, "give 0 m or more");
  checkSetting(p.window_ticks >= 1 && p.window_ticks <= Foaw::kMostTicks, "velocity window", p.window_ticks,
               "give 1 to 32 ticks");
  std::string known;
  for (std::size_t i = 0; i < kEntries.size(); ++i) {
    if (kEntries[i].name == p.name) return kMakers[i](p, rate_hz);
    known += (i == 0 ? "" : ", ") + std::string(kEntries[i].name);
  }
  throw Error(Error::Code::kBadInput, "velocity", formatted("'{}' is not known", p.name), "use one of: " + known);
}

}  // namespace

std::span<const VelocityEntry> velocityEstimates() noexcept {
  return kEntries;
}

VelocityEstimate::VelocityEstimate(const VelocityParameters& parameters, double rate_hz)
    : estimate_(make(parameters, rate_hz)) {}

}  // namespace palpate
