// SPDX-License-Identifier: Apache-2.0
// servo/devices/placed_device.hpp: puts a device, which has a frame of its own, into the scene.
//
//   x_W = at + scale R (x_D - shift),   F_D = force_scale R^T F_W.
// So a hand that moves by 1 mm moves the tool by `scale` mm, and feels `force_scale` times the scene's force: a wall of
// K N/m in the scene is one of force_scale scale K at the handle. Everything that the servo asks of the device is told
// in the scene's measures: a device of mass m moves there like one of m / (scale force_scale).
//   Clutch: while the handle's switch is pressed the tool stays where it is and there is no force; the hand may go back
// to where it has room. `shift` takes up the way.
//   A device that no force moves (SpaceMouse) begins at `at`, wherever it was moved before it was placed.
//   One device may be placed again, one placement after another: only one of them may be in a loop.
//   Beyond its workspace's radius a spring pushes the handle back, so that the end of the workspace is felt before the
// mechanics stop. A hand that begins outside is not pushed: there the edge begins where the hand is, and follows it in,
// never out. It begins anew with a run, after a jump, and when the device exerts forces again: calibrated, connected,
// or let go by its clutch. It moves only where its spring is slack, so this gives no energy.
// Frame W: world [m, N]. Threads as in device.hpp; no heap after construction.
#pragma once

#include <atomic>
#include <memory>

#include "servo/devices/device.hpp"

namespace palpate {

struct Placement {
  Vec3 at_W = Vec3::Zero();                            // where the middle of the device's workspace lies [m]
  Eigen::Matrix3d R_WD = Eigen::Matrix3d::Identity();  // the device's axes in the world; a rotation
  double scale = 1;                                    // metres of the scene for one of the device
  double force_scale = 1;                              // newtons of the device for one of the scene
  bool clutch = true;                                  // the handle's switch is one
  double edge_stiffness_N_per_m = 300;                 // at the handle, beyond the workspace; 0: no edge [N/m]
};

// The axes with which a user looks at a patient's face: right is the patient's left (+x), up is superior (+z), towards
// the user is anterior (-y).
[[nodiscard]] Eigen::Matrix3d facingThePatient();

class PlacedDevice final : public Device {
 public:
  // Throws Error(kBadInput) unless both scales are above 0 and finite, the place is finite, the edge not negative, and
  // R_WD a rotation.
  PlacedDevice(std::shared_ptr<Device> device, const Placement& placement);

  [[nodiscard]] std::string_view name() const noexcept override { return device_->name(); }
  [[nodiscard]] DeviceLimits limits() const noexcept override;
  [[nodiscard]] std::vector<HandParameters> hands() const override;
  [[nodiscard]] ForceOff forceOff() const noexcept override;
  [[nodiscard]] std::vector<DeviceFigure> figures() const override { return device_->figures(); }
  void elapse(int ticks) noexcept override { device_->elapse(ticks); }
  [[nodiscard]] bool read(Vec3& position_W) noexcept override;
  [[nodiscard]] std::int64_t reportAge_ns() const noexcept override { return device_->reportAge_ns(); }
  [[nodiscard]] CalibrationRefusal refusedCalibration() const noexcept override {
    return device_->refusedCalibration();
  }
  [[nodiscard]] bool pressed() const noexcept override { return device_->pressed(); }
  void beginAnew() noexcept override;
  void endRun() noexcept override { device_->endRun(); }
  [[nodiscard]] DeviceBoundary boundary() const noexcept override;
  [[nodiscard]] bool write(const Vec3& force_W) noexcept override;
  [[nodiscard]] Vec3 held(const Vec3& force_W) const noexcept override;

 private:
  [[nodiscard]] bool clutched() const noexcept { return placement_.clutch && device_->pressed(); }
  [[nodiscard]] Vec3 toDevice(const Vec3& force_W) const noexcept;
  void beginEdge() noexcept;

  std::shared_ptr<Device> device_;
  Placement placement_;
  double radius_m_;       // of the device's workspace, in D; 0: none is stated
  double edge_m_ = 0;     // where its edge is now, in D; radius_m_ at the least
  bool was_off_ = true;   // no force was exerted at the last read
  bool begins_at_place_;  // its first position is `at`
  Vec3 position_D_ = Vec3::Zero(), shift_D_ = Vec3::Zero();
  bool has_read_ = false;
  std::atomic<bool> was_clutched_{false};  // at the last read
};

}  // namespace palpate
