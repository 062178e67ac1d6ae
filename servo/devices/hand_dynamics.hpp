// SPDX-License-Identifier: Apache-2.0
// servo/devices/hand_dynamics.hpp: device and hand as one mass, stepped over a tick without integration error.
//
// The hand grips the device, so both masses move as one, x. A spring and a damper of the hand pull it along the path r.
// A damper of the device brakes it against the ground, and the servo's force F acts on it. Along each axis of the world
//   (m_hand + m_device) x'' = -k (x - r) - b_hand (x' - r') - b_device x' + F.
// F is held over the tick (zero order), as a real amplifier holds it. The path is interpolated linearly (first order):
// it runs straight between its values at the ends of a tick, and r' is the slope of that line. If r were held instead,
// the hand would feel a staircase, and its damper would never see the path move. If r and r' were interpolated
// separately, r' would not be the slope of r.
// Dry friction of the device, if it has any, is f_c against the motion along each axis, and holds the device still
// where everything else is weaker (Coulomb): -f_c sign(x'), or for x' = 0 whatever of at most f_c keeps it there. A
// tick is then cut where the motion stops or breaks loose, and is exact between these times (hand_friction.hpp). For
// these inputs the step is the exact solution, x(t + T) = Phi(T) x(t) + ... Phi is the matrix exponential of the system
// together with its inputs (Van Loan 1978). So one tick gives the same as two half ticks. Units: SI.
// Thread: const after construction. Cost of step(): 30 multiplications. Heap: none.
#pragma once

#include "base/vec.hpp"

namespace palpate {

struct HandParameters {
  double hand_mass_kg = 0.1;
  double hand_damping_Ns_per_m = 3.0;
  double hand_stiffness_N_per_m = 400;
  double device_mass_kg = 0.05;
  double device_damping_Ns_per_m = 0.1;
  double device_friction_N = 0;  // dry, along each axis
};

// By how much a force may jump from tick to tick without going on by itself: twice the dry friction of device and hand
// (Abbott and Okamura 2005, for walls whose encoders round), which is 0.02 N at least [N]. Measured: of 12,000 random
// contacts those that swung on had jumps of 0.06 N and more (docs/stability.md).
[[nodiscard]] double quietJump(const HandParameters& hand) noexcept;

// The damping up to which a servo brakes device and hand better with more of it, m / (T (1 + d) + 1 / (2 pi f_c)) [N
// s/m]. Its force is late by a tick, the device's d and the velocity's low-pass (f_c 0: none), and such a damping stops
// the mass within that time. A larger one comes too late: it swings by itself.
[[nodiscard]] double brakingDamping(const HandParameters& hand, double rate_hz, int delay_ticks,
                                    double velocity_cutoff_hz) noexcept;

class HandDynamics {
 public:
  struct State {
    Vec3 position_W = Vec3::Zero();  // [m]
    Vec3 velocity_W = Vec3::Zero();  // [m/s]
  };

  // Throws Error(kBadInput) unless the masses' sum is positive, the rest is not negative, and all is finite.
  HandDynamics(const HandParameters& parameters, double tick_s);

  // The state one tick later: the path went straight from `path_start_W` to `path_end_W`, the force was constant.
  [[nodiscard]] State step(const State& state, const Vec3& path_start_W, const Vec3& path_end_W,
                           const Vec3& force_W) const noexcept;

  // Rows: position, velocity. Columns: position, velocity, path at the start [m], path slope [m/s], force [N]. The
  // exact eigenvalues of the closed loop follow from it.
  using Transition = Eigen::Matrix<double, 2, 5>;
  [[nodiscard]] const Transition& transition() const noexcept { return transition_; }

 private:
  double tick_s_;
  HandParameters parameters_;
  Transition transition_;
};

}  // namespace palpate
