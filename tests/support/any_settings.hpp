// SPDX-License-Identifier: Apache-2.0
// Settings of a rig with every member at random, for what carries them from one form to another.
#pragma once

#include "apps/servo_setup/rig_settings.hpp"
#include "tests/servo/support/seeded.hpp"

namespace palpate {

inline RigSettings anySettings(Seeded& random) {
  RigSettings s;
  s.algorithm = random.pick(2) == 0 ? "hri" : "any \xC3\xA9";
  s.parameters = {random.between(-1e3, 1e3), random.between(0, 1e5), random.between(0, 10), 1 + random.pick(1000),
                  random.between(1, 20000)};
  s.force_limit_N = random.between(0, 100);
  for (int i = random.pick(4); i > 0; --i)
    s.haptization.density.push_back({random.between(-1, 1), random.between(-1, 1), random.between(0, 1)});
  for (int i = random.pick(4); i > 0; --i)
    s.haptization.gradient.push_back({random.between(0, 1), random.between(0, 9)});
  s.effects = {.force_shading = random.pick(2) == 0,
               .recovery_s = random.between(0, 1),
               .texture = static_cast<TextureKind>(random.pick(3)),
               .texture_amplitude_m = random.between(0, 1),
               .texture_wavelength_m = random.between(0, 1),
               .texture_gain = random.between(0, 1),
               .friction = {random.between(0, 1), random.between(0, 1), random.between(0, 1)}};
  for (int i = random.pick(4); i > 0; --i)
    s.effects.stiffness_by_density.push_back({random.between(0, 9), random.between(0, 9)});
  return s;
}

}  // namespace palpate
