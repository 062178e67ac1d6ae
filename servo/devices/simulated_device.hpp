// SPDX-License-Identifier: Apache-2.0
// servo/devices/simulated_device.hpp: a device that needs no hardware; a simulated hand moves it along a path.
//
// kRigid: the HIP is exactly on the path, whatever the force. kSpring: the hand pulls the device along the path and
// feels the force (hand_dynamics.hpp). In both cases encoders round the positions that are read, some reports may be
// dropped, the force is cut to the device's maximum, and it acts `delay_ticks` after the write. Only elapse() advances
// time, so the same forces give the same motion, bit for bit. Frame W: world [m, N]. Threads as in device.hpp; the path
// must outlive the device. Heap: in the constructor only.
#pragma once

#include <cstdint>
#include <vector>

#include "servo/devices/device.hpp"
#include "servo/devices/hand_dynamics.hpp"
#include "servo/devices/path.hpp"

namespace palpate {

enum class Hand { kRigid, kSpring };

struct SimulatedDeviceParameters {
  Hand hand = Hand::kRigid;
  HandParameters dynamics;          // of kSpring
  double force_limit_N = 8;         // [N]
  double slew_limit_N_per_s = 0;    // stated in limits(); 0: not stated [N/s]
  double encoder_resolution_m = 0;  // positions are multiples of it along each axis; 0: not rounded [m]
  int delay_ticks = 0;              // from write() to the force that acts [tick]
  double dropped_share = 0;         // of reports that do not come, at random but the same in each run [-]
};

class SimulatedDevice final : public Device {
 public:
  // Begins at rest at the path's start. Throws Error(kBadInput) on a rate or force limit that is not positive, a
  // negative resolution or slew limit, a delay outside 0 to 10000 ticks, and what HandDynamics refuses.
  SimulatedDevice(const SimulatedDeviceParameters& parameters, const Path& path, double rate_hz);

  [[nodiscard]] std::string_view name() const noexcept override;
  [[nodiscard]] DeviceLimits limits() const noexcept override;
  [[nodiscard]] std::vector<HandParameters> hands() const override;
  [[nodiscard]] std::int64_t reportAge_ns() const noexcept override;
  void elapse(int ticks) noexcept override;
  [[nodiscard]] bool read(Vec3& position_W) noexcept override;
  [[nodiscard]] bool leapt() noexcept override;
  [[nodiscard]] bool write(const Vec3& force_W) noexcept override;
  [[nodiscard]] Vec3 held(const Vec3& force_W) const noexcept override;

  // For tests and figures: the state without rounding, and the force that acts in the present tick.
  [[nodiscard]] const HandDynamics::State& state() const noexcept { return state_; }
  [[nodiscard]] const Vec3& actingForce() const noexcept { return written_W_[next_]; }

 private:
  [[nodiscard]] double timeOf(std::int64_t tick) const noexcept { return static_cast<double>(tick) / rate_hz_; }

  SimulatedDeviceParameters parameters_;
  const Path& path_;
  double rate_hz_;
  HandDynamics dynamics_;
  HandDynamics::State state_;
  std::int64_t tick_ = 0, reported_tick_ = 0;
  Vec3 reported_W_ = Vec3::Zero();  // the last position that was read
  std::vector<Vec3> written_W_;     // ring of delay_ticks + 1 forces; the one at next_ acts in this tick
  std::size_t next_ = 0;
  std::uint64_t leaps_ = 0;  // of the path
  bool leapt_ = false;       // and nobody has been told
};

}  // namespace palpate
