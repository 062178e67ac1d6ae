// SPDX-License-Identifier: Apache-2.0
// servo/devices/space_mouse_device.hpp: a SpaceMouse as a device that is moved and exerts no force.
//
// Its cap springs back, so it gives a velocity: pushed fully, `fastest_m_per_s`. Pushes within `dead_share` count as
// none. Reports come every 8 or 16 ms, in steps; the servo needs a position every tick, without steps of velocity. So
// the velocity follows the push like a mass in honey, v' = (push - v) / smooth_s, and the position is the exact
// integral of that between two reads. After silence of `silence_s` the push is none: a device at rest says nothing, and
// the report that said so may be lost.
// Frame D: x right, y up, z towards the user [m]; it begins at 0. The position stays within `workspace_radius_m`.
// Threads as in device.hpp. By the simulated clock time is the servo's.
#pragma once

#include <atomic>

#include "servo/devices/device.hpp"
#include "servo/devices/report_link.hpp"

namespace palpate {

struct SpaceMouseParameters {
  double fastest_m_per_s = 0.1;
  double dead_share = 0.03;
  double smooth_s = 0.03;
  double interval_s = 0.008;  // of its reports; 16 ms for wireless ones
  double silence_s = 0.1;
  double workspace_radius_m = 0.25;
};

// Throws Error(kBadInput) for parameters that no SpaceMouse can have.
void checkSpaceMouse(const SpaceMouseParameters& parameters);

struct SpaceMouseUse {
  bool simulated_clock = false;
  double rate_hz = 1000;  // of the servo [Hz]
  std::function<void()> thread_begins = {};
};

class SpaceMouseDevice final : public Device {
 public:
  // Throws Error as `open` does.
  SpaceMouseDevice(const SpaceMouseParameters& parameters, const SpaceMouseUse& use, PortOpener open);

  [[nodiscard]] std::string_view name() const noexcept override { return "SpaceMouse"; }
  [[nodiscard]] DeviceLimits limits() const noexcept override;
  [[nodiscard]] ForceOff forceOff() const noexcept override;
  [[nodiscard]] std::vector<DeviceFigure> figures() const override;
  void elapse(int ticks) noexcept override;
  [[nodiscard]] bool read(Vec3& position_D) noexcept override;
  [[nodiscard]] bool write(const Vec3& force_D) noexcept override { return force_D.allFinite(); }
  [[nodiscard]] std::uint32_t buttons() const noexcept { return buttons_; }

 private:
  void take(const Received& received) noexcept;
  void advance(double time_s) noexcept;

  SpaceMouseParameters parameters_;
  SpaceMouseUse use_;
  std::atomic<std::uint64_t> garbage_{0};  // counted by the link's thread
  ReportLink link_;
  std::uint64_t seen_ = 0;
  std::int64_t last_ns_ = 0;  // of the last read
  double since_report_s_ = 0;
  Vec3 push_D_ = Vec3::Zero();  // [m/s]
  Vec3 velocity_D_ = Vec3::Zero(), position_D_ = Vec3::Zero();
  std::uint32_t buttons_ = 0;
};

}  // namespace palpate
