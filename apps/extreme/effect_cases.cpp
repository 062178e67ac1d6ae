// SPDX-License-Identifier: Apache-2.0
// Effects beyond what is sensible, alone and all together.
#include <cmath>

#include "apps/extreme/ground.hpp"

namespace palpate {
namespace effect_cases {
namespace {

// Down, then along the plane at 50 mm/s and back.
RoughRun slide(const EffectParameters& effects) {
  const Ground ground{.size = Vec3i::Constant(48)};
  RoughRun run = pressOn(ground.sampled(), ground);
  const auto press_W = run.path_W;
  run.effects = effects;
  run.seconds = 1.2;
  run.path_W = [=](double time_s) -> Vec3 {
    const double slid_m = 10e-3 * std::sin(5 * std::max(0.0, time_s - 0.3));
    return press_W(time_s) + Vec3(slid_m, slid_m / 2, 0);
  };
  return run;
}

EffectParameters everyEffect() {
  EffectParameters all;
  all.force_shading = true;
  all.recovery_s = 0.05;
  all.texture = TextureKind::kProcedural;
  all.friction = {.static_ratio = 0.5, .dynamic_ratio = 0.3, .viscous_Ns_per_m = 1};
  all.stiffness_by_density = {{0, 0.2}, {2, 1}};
  return all;
}

void add(ExtremeCases& to, const char* name, const EffectParameters& effects, bool is_pushed = true) {
  to.push_back({"effects", name,
                is_pushed ? "the tool is pushed out, and no force is beyond the limits" : "no force beyond the limits",
                [=] {
                  const RoughRun run = slide(effects);
                  Judge judge(run, play(run));
                  if (is_pushed) judge.isPushed(Vec3::UnitZ(), 0.05).raisesNoFadingFault();
                  return judge.outcome();
                }});
}

}  // namespace
}  // namespace effect_cases

void addEffectCases(ExtremeCases& to) {
  using namespace effect_cases;
  add(to, "every effect at once", everyEffect());
  EffectParameters friction;
  friction.friction = {.static_ratio = 1000, .dynamic_ratio = 1000};
  add(to, "friction of 1000", friction, false);
  friction.friction = {.viscous_Ns_per_m = 1e6};
  add(to, "viscous friction of 1e6 N s/m", friction, false);
  EffectParameters texture;
  texture.texture = TextureKind::kProcedural;
  texture.texture_amplitude_m = 1;
  add(to, "a texture of 1 m", texture, false);
  texture.texture_amplitude_m = 1e-4;
  texture.texture_wavelength_m = 1e-12;
  add(to, "a texture with a wavelength of 1 pm", texture, false);
  texture.texture = TextureKind::kDensity;
  texture.texture_gain = 1e9;
  add(to, "a density texture with a gain of 1e9", texture, false);
  EffectParameters recovery;
  recovery.recovery_s = 1000;
  add(to, "a recovery of 1000 s", recovery);
  EffectParameters stiffness;
  stiffness.stiffness_by_density = {{-1e30, 0}, {0, 100}, {1e-30, 0}};
  add(to, "stiffness that jumps between 0 and a hundredfold", stiffness, false);
  EffectParameters shading;
  shading.force_shading = true;
  add(to, "force shading", shading);
}

}  // namespace palpate
