// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/servo_setup.hpp"

#include <cmath>

namespace palpate {
namespace {

VelocityParameters velocityParameters(const Scene& scene) {
  VelocityParameters velocity;
  velocity.name = scene.velocity;
  velocity.cutoff_hz = scene.velocity_cutoff_hz;
  velocity.noise_m = scene.velocity_noise_m;
  return velocity;
}

}  // namespace

LoopParameters loopParameters(const Scene& scene) {
  LoopParameters loop;
  loop.rate_hz = scene.rate_hz;
  loop.require_real_time = scene.require_real_time;
  loop.ticks = std::llround(scene.duration_s * scene.rate_hz);
  loop.safety = {.force_limit_N = scene.force_limit_N,
                 .slew_limit_N_per_s = scene.slew_limit_N_per_s,
                 .fade_s = scene.fade_s,
                 .stale_window_s = scene.stale_window_s,
                 .stall_s = scene.stall_s,
                 .report_timeout_s = scene.report_timeout_s};
  loop.velocity = velocityParameters(scene);
  loop.passivity.control = scene.passivity_control;
  return loop;
}

DeviceSetup deviceSetup(const Scene& scene, const Path& path) {
  return {.path = &path,
          .rate_hz = scene.rate_hz,
          .values = {{"spring_hand", scene.spring_hand ? 1 : 0},
                     {"hand_mass_kg", scene.hand_mass_kg},
                     {"hand_damping_Ns_per_m", scene.hand_damping_Ns_per_m},
                     {"hand_stiffness_N_per_m", scene.hand_stiffness_N_per_m},
                     {"mass_kg", scene.device_mass_kg},
                     {"damping_Ns_per_m", scene.device_damping_Ns_per_m},
                     {"force_limit_N", scene.force_limit_N},
                     {"encoder_resolution_m", scene.encoder_resolution_m},
                     {"delay_ticks", scene.device_delay_ticks}}};
}

}  // namespace palpate
