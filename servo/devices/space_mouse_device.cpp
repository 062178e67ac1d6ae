// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/space_mouse_device.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/monotonic_clock.hpp"
#include "base/units.hpp"
#include "servo/devices/space_mouse_report.hpp"

namespace palpate {
namespace {

const SpaceMouseParameters& checked(const SpaceMouseParameters& p) {
  checkSetting(p.fastest_m_per_s > 0, "speed of a full push", p.fastest_m_per_s, "give m/s above 0");
  checkSetting(p.dead_share >= 0 && p.dead_share < 1, "dead zone", p.dead_share, "give a share of 0 to below 1");
  checkSetting(p.smooth_s > 0, "smoothing", p.smooth_s, "give seconds above 0");
  checkSetting(p.interval_s > 0, "interval of reports", p.interval_s, "give seconds above 0");
  checkSetting(p.silence_s > p.interval_s, "silence", p.silence_s, "give more seconds than between two reports");
  checkSetting(p.workspace_radius_m > 0, "workspace", p.workspace_radius_m, "give metres above 0");
  return p;
}

// What several reports told together, as a report of its own: the newest push with its turn, then the buttons.
constexpr std::size_t kPushBytes = 7, kAllBytes = 13, kKnownBytes = 17;

bool isPushed(const Report& known) {
  const auto state = parseSpaceMouse(known.content().first(std::min(known.size, kAllBytes)));
  return state && state->push && *state->push != std::array<std::int16_t, 3>{};
}

void put(Report& known, std::size_t at, std::span<const std::uint8_t> bytes) {
  std::copy(bytes.begin(), bytes.end(), known.bytes.begin() + static_cast<std::ptrdiff_t>(at));
}

// False: it is no report of a SpaceMouse.
bool foldInto(Report& known, const Report& report) {
  const auto state = parseSpaceMouse(report.content());
  if (!state) return false;
  known.size = kKnownBytes;
  known.bytes[0] = 1;
  const std::span<const std::uint8_t> content = report.content().subspan(1);
  if (state->push) put(known, 1, content);
  if (state->turn && !state->push) put(known, kPushBytes, content);
  if (state->buttons) put(known, kAllBytes, content.first(std::min(content.size(), kKnownBytes - kAllBytes)));
  return true;
}

}  // namespace

void checkSpaceMouse(const SpaceMouseParameters& parameters) {
  static_cast<void>(checked(parameters));
}

SpaceMouseDevice::SpaceMouseDevice(const SpaceMouseParameters& parameters, const SpaceMouseUse& use, PortOpener open)
    : parameters_(checked(parameters)),
      use_(use),
      link_(std::move(open), {.answers = false,
                              .interval_s = parameters.interval_s,
                              .fold =
                                  [this](Report& known, const Report& report) {
                                    const bool told = foldInto(known, report);
                                    if (!told) garbage_.fetch_add(1, std::memory_order_relaxed);
                                    return told;
                                  },
                              .moves = isPushed,
                              .thread_begins = use.thread_begins}) {
  link_.start();
  last_ns_ = monotonicNow_ns();
}

DeviceLimits SpaceMouseDevice::limits() const noexcept {
  return {.follows_force = false, .workspace_radius_m = parameters_.workspace_radius_m};
}

ForceOff SpaceMouseDevice::forceOff() const noexcept {
  return link_.connected() ? ForceOff::kInputOnly : ForceOff::kDisconnected;
}

std::vector<DeviceFigure> SpaceMouseDevice::figures() const {
  const LinkFigures f = link_.figures();
  return {{"reports_received", static_cast<double>(f.received)},
          {"reports_lost", static_cast<double>(f.lost)},
          {"reports_superseded", static_cast<double>(f.superseded)},
          {"reports_garbled", static_cast<double>(garbage_.load(std::memory_order_relaxed))},
          {"disconnects", static_cast<double>(f.disconnects)},
          {"reconnects", static_cast<double>(f.reconnects)}};
}

void SpaceMouseDevice::take(const Received& received) noexcept {
  if (received.number == seen_) return;
  seen_ = received.number;
  const auto state = parseSpaceMouse(received.report.content().first(kAllBytes));
  buttons_ = 0;
  for (std::size_t i = kKnownBytes; i > kAllBytes; --i) buttons_ = buttons_ << 8U | received.report.bytes[i - 1];
  since_report_s_ = 0;
  // The device's y points to the user and its z down; D's z points to the user and its y up.
  const Vec3 push = Vec3((*state->push)[0], -(*state->push)[2], (*state->push)[1]) / kSpaceMouseFullPush;
  for (int axis = 0; axis < 3; ++axis) {
    const double size = std::min(1.0, std::abs(push[axis]));
    const double beyond = std::max(0.0, size - parameters_.dead_share) / (1 - parameters_.dead_share);
    push_D_[axis] = std::copysign(beyond * parameters_.fastest_m_per_s, push[axis]);
  }
}

// v' = (u - v) / s with a constant u: v(t) = u + (v - u) e^(-t/s), whose integral is u t + (v - u) s (1 - e^(-t/s)).
void SpaceMouseDevice::advance(double time_s) noexcept {
  since_report_s_ += time_s;
  const Vec3 push_D = since_report_s_ > parameters_.silence_s || !link_.connected() ? Vec3(Vec3::Zero()) : push_D_;
  const double left = std::exp(-time_s / parameters_.smooth_s);
  position_D_ += push_D * time_s + (velocity_D_ - push_D) * (parameters_.smooth_s * (1 - left));
  velocity_D_ = push_D + (velocity_D_ - push_D) * left;
  const double far_m = position_D_.norm();
  if (far_m > parameters_.workspace_radius_m) position_D_ *= parameters_.workspace_radius_m / far_m;
}

void SpaceMouseDevice::elapse(int ticks) noexcept {
  if (use_.simulated_clock) advance(ticks / use_.rate_hz);
}

bool SpaceMouseDevice::read(Vec3& position_D) noexcept {
  if (!use_.simulated_clock) {
    const std::int64_t now_ns = monotonicNow_ns();
    advance(static_cast<double>(now_ns - last_ns_) / kNanosecondsPerSecond);
    last_ns_ = now_ns;
  }
  take(link_.newest());
  position_D = position_D_;
  return true;
}

}  // namespace palpate
