// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/recording_device.hpp"

#include <cmath>
#include <limits>

#include "base/units.hpp"

namespace palpate {

RecordingDevice::RecordingDevice(std::unique_ptr<Device> device, double rate_hz, std::size_t most_ticks)
    : device_(std::move(device)), rate_hz_(rate_hz) {
  ticks_.reserve(most_ticks);
}

void RecordingDevice::elapse(int ticks) noexcept {
  elapsed_ += ticks;
  device_->elapse(ticks);
}

bool RecordingDevice::read(Vec3& position_W) noexcept {
  if (!has_ended_ && ticks_.size() < ticks_.capacity()) {
    ticks_.emplace_back();
    now_ = &ticks_.back();
  } else {
    now_ = &unkept_;
  }
  *now_ = {.elapsed_ticks = elapsed_};
  elapsed_ = 0;
  now_->answered = device_->read(position_W);
  now_->position_W = position_W;
  now_->pressed = device_->pressed();
  now_->force_off = device_->forceOff();
  now_->refused = device_->refusedCalibration();
  return now_->answered;
}

void RecordingDevice::endRun() noexcept {
  has_ended_ = true;
  now_ = &unkept_;
  device_->endRun();
}

std::int64_t RecordingDevice::reportAge_ns() const noexcept {
  return now_->report_age_ns = device_->reportAge_ns();
}

DeviceBoundary RecordingDevice::boundary() const noexcept {
  return now_->boundary = device_->boundary();
}

bool RecordingDevice::write(const Vec3& force_W) noexcept {
  return now_->taken = device_->write(force_W);
}

Vec3 RecordingDevice::held(const Vec3& force_W) const noexcept {
  const Vec3 held_W = device_->held(force_W);
  now_->held_differs = held_W != force_W;
  now_->held_W = now_->held_differs ? held_W : Vec3(Vec3::Zero());
  return held_W;
}

Recording RecordingDevice::recording() const {
  return {.device = std::string(device_->name()),
          .rate_hz = rate_hz_,
          .limits = device_->limits(),
          .hands = device_->hands(),
          .ticks = ticks_};
}

std::int64_t RecordedDevice::reportAge_ns() const noexcept {
  if (is_new_) return tick().report_age_ns;
  return tick().report_age_ns +
         std::llround(static_cast<double>(grid_ - due_) * (kNanosecondsPerSecond / recording_->rate_hz));
}

// Where the servo left out grid points, the next read came later; until then there is nothing new.
bool RecordedDevice::read(Vec3& position_W) noexcept {
  is_new_ = false;
  const std::size_t next = begun_ ? at_ + 1 : 0;
  if (next < recording_->ticks.size() && grid_ >= due_ + (begun_ ? recording_->ticks[next].elapsed_ticks : 0)) {
    due_ += begun_ ? recording_->ticks[next].elapsed_ticks : 0;
    at_ = next;
    begun_ = is_new_ = true;
  } else if (next >= recording_->ticks.size()) {
    return false;
  }
  force_off_.store(tick().force_off, std::memory_order_relaxed);
  if (!tick().answered) return false;
  position_W = tick().position_W;
  return true;
}

}  // namespace palpate
