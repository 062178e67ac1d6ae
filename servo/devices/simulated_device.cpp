// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/simulated_device.hpp"

#include <cmath>
#include <utility>

#include "base/error.hpp"
#include "base/units.hpp"

namespace palpate {
namespace {

const SimulatedDeviceParameters& checked(const SimulatedDeviceParameters& p, double rate_hz) {
  checkSetting(rate_hz > 0, "rate", rate_hz, "give a positive rate in Hz");
  checkSetting(p.force_limit_N > 0, "device force limit", p.force_limit_N, "give newtons above 0");
  checkSetting(p.slew_limit_N_per_s >= 0, "device slew limit", p.slew_limit_N_per_s, "give 0 N/s (none) or more");
  checkSetting(p.encoder_resolution_m >= 0, "encoder resolution", p.encoder_resolution_m, "give 0 m or more");
  checkSetting(p.dropped_share >= 0 && p.dropped_share < 1, "share of dropped reports", p.dropped_share,
               "give 0 to below 1");
  checkSetting(p.delay_ticks >= 0 && p.delay_ticks <= 10000, "device delay", p.delay_ticks, "give 0 to 10000 ticks");
  return p;
}

// Even between 0 and 1, by the number of the tick (SplitMix64, Steele et al. 2014).
double chance(std::int64_t tick) noexcept {
  std::uint64_t bits = static_cast<std::uint64_t>(tick) * 0x9E3779B97F4A7C15U;
  bits = (bits ^ bits >> 30U) * 0xBF58476D1CE4E5B9U;
  bits = (bits ^ bits >> 27U) * 0x94D049BB133111EBU;
  return static_cast<double>((bits ^ bits >> 31U) >> 11U) * 0x1p-53;
}

}  // namespace

SimulatedDevice::SimulatedDevice(const SimulatedDeviceParameters& parameters, const Path& path, double rate_hz)
    : parameters_(checked(parameters, rate_hz)),
      path_(path),
      rate_hz_(rate_hz),
      dynamics_(parameters.dynamics, 1 / rate_hz),
      written_W_(static_cast<std::size_t>(parameters.delay_ticks) + 1, Vec3::Zero()) {
  state_.position_W = path.position(0);
}

std::string_view SimulatedDevice::name() const noexcept {
  return parameters_.hand == Hand::kRigid ? "simulated, rigid hand" : "simulated, spring hand";
}

DeviceLimits SimulatedDevice::limits() const noexcept {
  return {.force_limit_N = parameters_.force_limit_N,
          .position_resolution_m = parameters_.encoder_resolution_m,
          .force_delay_ticks = parameters_.delay_ticks,
          .slew_limit_N_per_s = parameters_.slew_limit_N_per_s,
          .follows_force = parameters_.hand == Hand::kSpring};
}

std::vector<HandParameters> SimulatedDevice::hands() const {
  if (parameters_.hand == Hand::kRigid) return {};
  return {parameters_.dynamics};
}

// The servo writes in every tick that it runs. Over ticks that it missed, the device holds the last force, as hardware
// does.
void SimulatedDevice::elapse(int ticks) noexcept {
  for (int i = 0; i < ticks; ++i) {
    const Vec3 start_W = path_.position(timeOf(tick_));
    const Vec3 end_W = path_.position(timeOf(++tick_));
    if (std::exchange(leaps_, path_.leaps()) != path_.leaps()) {  // a hand puts it there, without force
      leapt_ = true;
      state_ = {end_W, Vec3::Zero()};
      for (Vec3& force_W : written_W_) force_W.setZero();
    } else if (parameters_.hand == Hand::kRigid) {
      state_ = {end_W, (end_W - start_W) * rate_hz_};
    } else {
      state_ = dynamics_.step(state_, start_W, end_W, written_W_[next_]);
    }
    const std::size_t size = written_W_.size();
    const Vec3 newest_W = written_W_[(next_ + size - 1) % size];
    next_ = (next_ + 1) % size;
    written_W_[(next_ + size - 1) % size] = newest_W;
  }
}

// Where a report was dropped, the last one is all there is.
bool SimulatedDevice::read(Vec3& position_W) noexcept {
  if (tick_ > 0 && parameters_.dropped_share > 0 && chance(tick_) < parameters_.dropped_share) {
    position_W = reported_W_;
    return true;
  }
  const double resolution_m = parameters_.encoder_resolution_m;
  position_W = state_.position_W;
  if (resolution_m > 0) {
    for (double& x : position_W) x = std::round(x / resolution_m) * resolution_m;
  }
  reported_W_ = position_W;
  reported_tick_ = tick_;
  return true;
}

// With the report of the new place, and not of one before.
bool SimulatedDevice::leapt() noexcept {
  return reported_tick_ == tick_ && std::exchange(leapt_, false);
}

std::int64_t SimulatedDevice::reportAge_ns() const noexcept {
  return std::llround(static_cast<double>(tick_ - reported_tick_) * kNanosecondsPerSecond / rate_hz_);
}

bool SimulatedDevice::write(const Vec3& force_W) noexcept {
  if (!force_W.allFinite()) return false;
  const std::size_t newest = (next_ + written_W_.size() - 1) % written_W_.size();
  written_W_[newest] = held(force_W);
  return true;
}

Vec3 SimulatedDevice::held(const Vec3& force_W) const noexcept {
  const double size_N = force_W.stableNorm();
  const double limit_N = parameters_.force_limit_N;
  return size_N > limit_N ? Vec3(force_W / size_N * limit_N) : force_W;
}

}  // namespace palpate
