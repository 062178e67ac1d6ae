// SPDX-License-Identifier: Apache-2.0
// servo/stability/passivity_bounds.hpp: bounds under which a sampled wall gives no energy, whoever holds the device.
//
// A wall may break them and still be stable with a certain hand: the exact limit for that hand is in sampled_loop.hpp.
// T = 1 / rate. Units: SI. Any thread; no cost, no errors.
#pragma once

namespace palpate {

// What of a device counts for passivity: friction of its own, encoders, rate.
struct PassiveDevice {
  double damping_Ns_per_m = 0;    // b
  double coulomb_friction_N = 0;  // f_c
  double resolution_m = 0;        // Delta; 0: encoders round nothing
  double rate_hz = 1000;
};

// Colgate and Schenkel 1997: b > K T / 2 + |B|. The stiffness up to which it holds [N/m]; 0 if it holds for none.
[[nodiscard]] double samplingBound(const PassiveDevice& device, double damping_Ns_per_m);

// Abbott and Okamura 2005: K <= min(2 b / T, 2 f_c / Delta), for B = 0. The second term alone [N/m]; infinity without
// rounding.
[[nodiscard]] double quantisationBound(const PassiveDevice& device);

// The smaller of both [N/m].
[[nodiscard]] double passiveStiffness(const PassiveDevice& device, double damping_Ns_per_m);

}  // namespace palpate
