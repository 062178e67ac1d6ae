// SPDX-License-Identifier: Apache-2.0
// servo/devices/device.hpp: what the servo asks of a haptic device, real or simulated.
//
// Frame W: world; a device that has a frame of its own turns into the world itself. Units [m, N].
// Threads: read(), reportAge_ns(), write(), held() and elapse() by the servo thread alone, in each tick elapse, read,
// reportAge_ns, write, held; no heap, lock or throw in them, and no system call but the device's own I/O, which must not
// wait. The rest before the loop starts.
// Errors: false from read() or write() means that the device did not answer; the servo then fades the force to zero. A
// write that gave false was not taken: the device goes on holding what it took last.
#pragma once

#include <cstdint>
#include <string_view>

#include "base/vec.hpp"

namespace palpate {

struct DeviceLimits {
  double force_limit_N = 0;          // largest force in any direction [N]
  double position_resolution_m = 0;  // of its encoders; 0: none to speak of [m]
  int force_delay_ticks = 0;         // from write() to the force that acts, in servo ticks
  double slew_limit_N_per_s = 0;     // fastest change of force that it should be asked for; 0: none said [N/s]
};

class Device {
 public:
  virtual ~Device() = default;
  [[nodiscard]] virtual std::string_view name() const noexcept = 0;
  [[nodiscard]] virtual DeviceLimits limits() const noexcept = 0;

  // Grid periods that have passed since the last tick: 1, or more where deadlines were missed; not called before the
  // first tick. A real device has its own time and leaves this empty.
  virtual void elapse(int ticks) noexcept { static_cast<void>(ticks); }
  // Where the HIP is now; `position_W` is left alone on failure.
  [[nodiscard]] virtual bool read(Vec3& position_W) noexcept = 0;
  // How old the position is that the last read() gave [ns]: a device that sends reports of its own accord says how long
  // ago the newest one came. One that is asked and answers at once leaves this 0. The servo takes a position whose age
  // is not less than the time since its last tick for one that it has had already.
  [[nodiscard]] virtual std::int64_t reportAge_ns() const noexcept { return 0; }
  // The force to hold until the next write.
  [[nodiscard]] virtual bool write(const Vec3& force_W) noexcept = 0;
  // What the device holds after a write() of `force_W` that it took: the same, or less where it cuts to a limit of its
  // own. A device that only rounds forces leaves this alone: a step below its rounding would never get anywhere.
  [[nodiscard]] virtual Vec3 held(const Vec3& force_W) const noexcept { return force_W; }
};

}  // namespace palpate
