// SPDX-License-Identifier: Apache-2.0
// servo/devices/typical_hands.hpp: three hands that hold a haptic device, for what must hold in any hand.
//
// Hasser and Cutkosky (2002) and Fu and Cavusoglu (2012) identified hands on haptic devices: a mass that depends little
// on the grip, stiffness and damping that grow with it several times. The values here are round ones of that size, no
// measurements of their own. A light hand holds a wall least stable by its little damping, a stiff one adds a spring.
// Units: SI. Any thread; no cost.
#pragma once

#include <array>

#include "servo/devices/hand_dynamics.hpp"

namespace palpate {

struct TypicalHand {
  const char* name;
  double mass_kg, damping_Ns_per_m, stiffness_N_per_m;

  // The same device in this hand.
  [[nodiscard]] HandParameters holding(HandParameters device) const noexcept {
    device.hand_mass_kg = mass_kg;
    device.hand_damping_Ns_per_m = damping_Ns_per_m;
    device.hand_stiffness_N_per_m = stiffness_N_per_m;
    return device;
  }
};

inline constexpr std::array kTypicalHands = {
    TypicalHand{"light", 0.05, 1, 100},
    TypicalHand{"normal", HandParameters{}.hand_mass_kg, HandParameters{}.hand_damping_Ns_per_m,
                HandParameters{}.hand_stiffness_N_per_m},
    TypicalHand{"stiff", 0.15, 10, 1500},
};

}  // namespace palpate
