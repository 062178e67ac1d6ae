// SPDX-License-Identifier: Apache-2.0
#include "apps/extreme/judge.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "base/error.hpp"

namespace palpate {
namespace {

// Forces are sums of a few products; the bounds are kept to some roundings.
constexpr double kRounding = 1 + 1e-9;

}  // namespace

Judge::Judge(const RoughRun& run, RoughResult result) : run_(run), result_(std::move(result)) {
  const Referee& seen = result_.referee;
  that(!result_.records.empty(), "no tick was run");
  that(seen.not_finite == 0, fmt::format("{} forces are not finite", seen.not_finite));
  that(seen.largest_N <= result_.force_limit_N * kRounding,
       fmt::format("a force of {:g} N is beyond the limit of {:g} N", seen.largest_N, result_.force_limit_N));
  that(seen.largest_change_N <= result_.slew_per_tick_N * kRounding,
       fmt::format("a force changed by {:g} N, beyond the slew of {:g} N a tick", seen.largest_change_N,
                   result_.slew_per_tick_N));
  for (const TickRecord& record : result_.records) {
    constexpr double kUnit = 1e-9;
    const double length = asVec3(record.normal_W).stableNorm();
    if (asVec3(record.vhip_W).allFinite() && asVec3(record.hip_W).allFinite() &&
        (length == 0 || std::abs(length - 1) < kUnit))
      continue;
    that(false, fmt::format("tick {}: a VHIP that is not finite, or a normal of length {:g}", record.tick, length));
    break;
  }
}

std::size_t Judge::lastTenth() const noexcept {
  return result_.records.size() - std::max<std::size_t>(1, result_.records.size() / 10);
}

Judge& Judge::that(bool holds, const std::string& otherwise) {
  if (!holds) differs_ += (differs_.empty() ? "" : "; ") + otherwise;
  return *this;
}

Judge& Judge::feels(const ExactPlane& plane, double position_m) {
  const double stiffness = run_.parameters.stiffness_N_per_m;
  for (std::size_t i = lastTenth(); i < result_.records.size(); ++i) {
    const TickRecord& record = result_.records[i];
    if (!record.in_contact) return that(false, fmt::format("tick {}: no contact", record.tick));
    const Vec3 exact_W = stiffness * plane.depth_m(asVec3(record.hip_W)) * plane.normal_W;
    const double off_N = (asVec3(record.force_W) - exact_W).norm();
    if (!(off_N <= stiffness * position_m)) {
      return that(false, fmt::format("tick {}: the force is off by {:g} N of {:g} N, and {:g} N is allowed",
                                     record.tick, off_N, exact_W.norm(), stiffness * position_m));
    }
  }
  return *this;
}

Judge& Judge::isPushed(const Vec3& out_W, double least_N) {
  for (std::size_t i = lastTenth(); i < result_.records.size(); ++i) {
    const TickRecord& record = result_.records[i];
    const Vec3 force_W = asVec3(record.force_W);
    if (force_W.norm() >= least_N && force_W.dot(out_W) >= 0.5 * force_W.norm()) continue;
    return that(false, fmt::format("tick {}: a force of {:g} N, {:g} N of it outward", record.tick, force_W.norm(),
                                   force_W.dot(out_W)));
  }
  return *this;
}

Judge& Judge::feelsNothing() {
  return that(result_.referee.largest_N == 0, fmt::format("there is a force of {:g} N", result_.referee.largest_N));
}

Judge& Judge::endsWithoutForce() {
  if (result_.records.empty()) return *this;
  const double last_N = asVec3(result_.records.back().force_W).norm();
  return that(last_N == 0, fmt::format("it ends with {:g} N", last_N));
}

Judge& Judge::raises(ServoFault fault) {
  return that(has(result_.faults(), fault), fmt::format("{} is not told", faultNames(bit(fault))));
}

Judge& Judge::doesNotRaise(ServoFault fault) {
  return that(!has(result_.faults(), fault), fmt::format("{} is told", faultNames(bit(fault))));
}

Judge& Judge::raisesNoFadingFault() {
  const std::uint32_t fading = result_.faults() & kFadingFaults;
  return that(fading == 0, fmt::format("{} is told", faultNames(fading)));
}

ExtremeOutcome Judge::outcome(const std::string& more) const {
  const std::string seen = fmt::format("{}{:.3g} N at most, contact in {} of {} ticks, faults: {}",
                                       more.empty() ? "" : more + "; ", result_.referee.largest_N,
                                       result_.contactTicks(), result_.records.size(), faultNames(result_.faults()));
  return {differs_.empty(), differs_.empty() ? seen : differs_ + " (" + seen + ")"};
}

ExtremeOutcome refusedWith(const std::string& words, const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    const std::string told = error.what();
    return {told.find(words) != std::string::npos, "refused: " + told};
  }
  return {false, "it was not refused"};
}

}  // namespace palpate
