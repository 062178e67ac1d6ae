// SPDX-License-Identifier: Apache-2.0
// servo/devices/recording_device.hpp: a device that keeps all that it and the servo say to each other.
//
// Memory for `most_ticks` reads is taken in the constructor; what comes after them, or after the run, is not kept.
// Threads as in device.hpp; recording() after the loop has ended.
#pragma once

#include <atomic>
#include <memory>

#include "servo/devices/device.hpp"
#include "servo/devices/recording.hpp"

namespace palpate {

class RecordingDevice final : public Device {
 public:
  RecordingDevice(std::unique_ptr<Device> device, double rate_hz, std::size_t most_ticks);

  [[nodiscard]] std::string_view name() const noexcept override { return device_->name(); }
  [[nodiscard]] DeviceLimits limits() const noexcept override { return device_->limits(); }
  [[nodiscard]] std::vector<HandParameters> hands() const override { return device_->hands(); }
  [[nodiscard]] ForceOff forceOff() const noexcept override { return device_->forceOff(); }
  [[nodiscard]] std::vector<DeviceFigure> figures() const override { return device_->figures(); }
  [[nodiscard]] CalibrationRefusal calibrate() noexcept override { return device_->calibrate(); }
  void elapse(int ticks) noexcept override;
  [[nodiscard]] bool read(Vec3& position_W) noexcept override;
  [[nodiscard]] std::int64_t reportAge_ns() const noexcept override;
  [[nodiscard]] CalibrationRefusal refusedCalibration() const noexcept override { return now_->refused; }
  [[nodiscard]] bool pressed() const noexcept override { return device_->pressed(); }
  [[nodiscard]] bool leapt() noexcept override { return now_->leapt = device_->leapt(); }
  void beginAnew() noexcept override { device_->beginAnew(); }
  void endRun() noexcept override;
  [[nodiscard]] DeviceBoundary boundary() const noexcept override;
  [[nodiscard]] bool write(const Vec3& force_W) noexcept override;
  [[nodiscard]] Vec3 held(const Vec3& force_W) const noexcept override;

  [[nodiscard]] Recording recording() const;

 private:
  std::unique_ptr<Device> device_;
  double rate_hz_;
  // What const functions of the servo's thread note, too.
  mutable std::vector<RecordedTick> ticks_;
  mutable RecordedTick unkept_;
  mutable RecordedTick* now_ = &unkept_;
  std::int32_t elapsed_ = 0;
  bool has_ended_ = false;
};

// Plays a recording back, read by read: the same positions, ages, refusals and held forces, whatever the servo does.
// Past its end it gives no position. By the simulated clock the servo then does the same, bit for bit.
class RecordedDevice final : public Device {
 public:
  explicit RecordedDevice(std::shared_ptr<const Recording> recording) : recording_(std::move(recording)) {}

  [[nodiscard]] std::string_view name() const noexcept override { return recording_->device; }
  [[nodiscard]] DeviceLimits limits() const noexcept override { return recording_->limits; }
  [[nodiscard]] std::vector<HandParameters> hands() const override { return recording_->hands; }
  [[nodiscard]] ForceOff forceOff() const noexcept override { return force_off_.load(std::memory_order_relaxed); }
  void elapse(int ticks) noexcept override { grid_ += ticks; }
  [[nodiscard]] bool read(Vec3& position_W) noexcept override;
  // Where the servo of the session left out grid points, the last position grows older meanwhile.
  [[nodiscard]] std::int64_t reportAge_ns() const noexcept override;
  [[nodiscard]] CalibrationRefusal refusedCalibration() const noexcept override { return tick().refused; }
  [[nodiscard]] bool pressed() const noexcept override { return tick().pressed; }
  [[nodiscard]] bool leapt() noexcept override { return is_new_ && tick().leapt; }
  [[nodiscard]] DeviceBoundary boundary() const noexcept override { return tick().boundary; }
  [[nodiscard]] bool write(const Vec3& force_W) noexcept override { return force_W.allFinite() && tick().taken; }
  [[nodiscard]] Vec3 held(const Vec3& force_W) const noexcept override {
    return tick().held_differs ? tick().held_W : force_W;
  }

 private:
  [[nodiscard]] const RecordedTick& tick() const noexcept { return recording_->ticks[at_]; }

  std::shared_ptr<const Recording> recording_;
  std::size_t at_ = 0;  // the tick that was read last
  bool begun_ = false, is_new_ = false;
  std::int64_t grid_ = 0;                             // periods that elapsed
  std::int64_t due_ = 0;                              // periods after which tick `at_` was read
  std::atomic<ForceOff> force_off_{ForceOff::kNone};  // at the last read
};

}  // namespace palpate
