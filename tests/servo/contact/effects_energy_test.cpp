// SPDX-License-Identifier: Apache-2.0
// No effect, nor any two, give a hand more than 1 % of what the contact stored, on random closed ways over random
// bodies. What the plane alone gives on the same way (its normal is not quite the slope of its depth where samples are
// coarse, and it jumps where it is renewed seldom) is not the effects', times the largest factor of its stiffness.
#include <array>
#include <optional>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "contact/energy_cycles.hpp"
#include "servo/contact/energy_account.hpp"

namespace palpate {
namespace effects_energy_test {

enum Effect { kShading, kRecovery, kProcedural, kDensity, kFriction, kStiffness, kEffects };
constexpr const char* kNames[] = {"shading",         "recovery", "procedural texture",
                                  "density texture", "friction", "stiffness"};

constexpr double kShareOfStored = 0.01;

// Parameters from all over what a user may set.
void add(EffectParameters& p, Effect effect, Dice& dice, double density_below) {
  switch (effect) {
    case kShading:
      p.force_shading = true;
      break;
    case kRecovery:
      p.recovery_s = dice.spread(1e-3, 1);
      break;
    case kProcedural:
    case kDensity:
      p.texture = effect == kProcedural ? TextureKind::kProcedural : TextureKind::kDensity;
      p.texture_amplitude_m = dice.spread(0.01e-3, 5e-3);
      p.texture_wavelength_m = dice.spread(0.2e-3, 20e-3);
      p.texture_gain = dice.spread(0.1, 1000);
      break;
    case kFriction:
      p.friction.static_ratio = dice.between(0, 2);
      p.friction.dynamic_ratio = dice.between(0, p.friction.static_ratio);
      p.friction.viscous_Ns_per_m = dice.coin() ? dice.between(0, 5) : 0;
      break;
    case kStiffness: {
      const double low = dice.coin() ? dice.between(0, 1) : 0, high = dice.spread(1, 100);
      const double middle = density_below * dice.between(0.7, 1.3), half = density_below * dice.spread(1e-3, 0.5);
      const bool falls = dice.coin();
      p.stiffness_by_density = {{middle - half, falls ? high : low}, {middle + half, falls ? low : high}};
      break;
    }
    case kEffects:
      break;
  }
}

double largestFactor(const EffectParameters& p) {
  double largest = 1;
  for (const StiffnessRow& row : p.stiffness_by_density) largest = std::max(largest, row.factor);
  return largest;
}

EnergyBody bodyOf(int kind, Dice& dice) {
  if (kind == 0) return EnergyBody::plane(dice);
  if (kind == 3) return EnergyBody::knot(dice);
  return EnergyBody::ball(dice, kind == 2);
}

struct Condition {
  const char* name;
  int n;
  double noise;    // of the samples [voxel]
  double step_m;   // in a tick
  bool waves_too;  // steps are short beside the texture's waves; otherwise waves are made long beside the steps
  std::uint32_t seeds;
};

void expectNothingGiven(const Condition& condition) {
  int contacts = 0;
  double largest = 0;
  for (int body_kind = 0; body_kind < 4; ++body_kind) {
    for (int lattice = 0; lattice < 3; ++lattice) {
      for (std::uint32_t seed = 1; seed <= condition.seeds; ++seed) {
        Dice body_dice(100 * seed + 10 * static_cast<std::uint32_t>(body_kind) + static_cast<std::uint32_t>(lattice));
        const EnergyBody body = bodyOf(body_kind, body_dice);
        const double noise_m = condition.noise * (lattice == 0 ? 1e-3 : 0.5e-3);
        const EnergyVolume volume(body, lattice, noise_m, seed);
        for (int a = 0; a < kEffects; ++a) {
          for (int b = a; b < kEffects; ++b) {
            if (a == kProcedural && b == kDensity) continue;  // there is one texture
            Dice dice(1000 * seed + 100 * static_cast<std::uint32_t>(body_kind) +
                      static_cast<std::uint32_t>(7 * a + 31 * b + lattice));
            EffectParameters p;
            const double density_below = EnergyVolume::kSteepness * (lattice == 0 ? 2.5e-3 : 4e-3);
            add(p, static_cast<Effect>(a), dice, density_below);
            if (b > a) add(p, static_cast<Effect>(b), dice, density_below);
            double step_m = condition.step_m;
            if (p.texture == TextureKind::kProcedural) {
              if (condition.waves_too) step_m = std::min(step_m, p.texture_wavelength_m / 40);
              if (!condition.waves_too) p.texture_wavelength_m = std::max(p.texture_wavelength_m, 10 * step_m);
            }
            const EnergyWay way = randomCycle(body, dice, step_m);
            const Cycle plane = energyOf(volume, way, {}, condition.n, 1000);
            const Cycle cycle = energyOf(volume, way, p, condition.n, 1000);
            if (plane.lost > 0) continue;  // each contact has an account of its own
            ++contacts;
            // A table may leave next to nothing of K: then of a hundredth of what the plane stores.
            const double stored_J = std::max(cycle.stored_J, 1e-2 * plane.stored_J);
            ASSERT_GT(stored_J, 0);
            // Where an effect has no potential, as stiffness by density beside borders, the account acts a tick late:
            // by the work of one tick's force. On exact samples with short steps nothing is left of that.
            const bool acts_late = condition.noise > 0 && (a == kStiffness || b == kStiffness);
            const double late_J = acts_late ? cycle.largest_N * step_m : 0;
            EXPECT_LE(cycle.given_J, kShareOfStored * stored_J + largestFactor(p) * plane.given_J + late_J)
                << condition.name << ": " << kNames[a] << " and " << kNames[b] << " on a " << body.name << ", lattice "
                << lattice << ", seed " << seed;
            largest = std::max(largest, (cycle.given_J - largestFactor(p) * plane.given_J) / stored_J);
          }
        }
      }
    }
  }
  EXPECT_GT(contacts, static_cast<int>(200 * condition.seeds));  // of 240
  testing::Test::RecordProperty(fmt::format("largest_share_given_n{}_noise{:g}", condition.n, condition.noise),
                                fmt::format("{:.5f} of {} contacts", largest, contacts));
}

// Steps of at most 20 um and a 40th of the texture's wavelength: the trapezoid errs by (2 pi / 40)^2 / 12 = 0.2 % of a
// wave's own energy, and by the change of slope of the field over a step elsewhere.
TEST(EffectsEnergy, SlowlyWithAPlaneATickNothingIsGiven) {
  expectNothingGiven({"slowly, n = 1", 1, 0, 0.02e-3, true, 2});
}

// 0.1 m/s at 1 kHz, on samples with noise.
TEST(EffectsEnergy, FastOnNoiseNothingIsGiven) {
  expectNothingGiven({"fast, n = 1", 1, 0.1, 0.1e-3, false, 2});
}

TEST(EffectsEnergy, WithPlanesRenewedSeldomNoMoreIsGivenThanByThem) {
  expectNothingGiven({"fast, n = 5", 5, 0.05, 0.1e-3, false, 1});
  expectNothingGiven({"fast, n = 20", 20, 0.05, 0.1e-3, false, 1});
}

// On a plane, which samples hold exactly, the potentials are exact: what is given is a hundredth of what the account
// would let pass. Stiffness by density has none in a deep press.
TEST(EffectsEnergy, OnAPlaneEveryPotentialIsExact) {
  for (int a = 0; a < kEffects; ++a) {
    if (a == kStiffness) continue;
    for (int lattice = 0; lattice < 3; ++lattice) {
      Dice dice(77 + static_cast<std::uint32_t>(3 * a + lattice));
      const EnergyBody body = EnergyBody::plane(dice);
      const EnergyVolume volume(body, lattice, 0, 5);
      EffectParameters p;
      add(p, static_cast<Effect>(a), dice, EnergyVolume::kSteepness * 3e-3);
      const double step_m = std::min(0.02e-3, p.texture_wavelength_m / 40);
      const Cycle cycle = energyOf(volume, randomCycle(body, dice, step_m), p, 1, 1000);
      EXPECT_LE(cycle.given_J, 1e-4 * cycle.stored_J) << kNames[a] << " " << lattice;
    }
  }
}

// Steps half as long make the force's steps half as long: there is no jump in it. Friction slips, and sticks, by jumps
// of the friction force alone; it is left out. Beside borders stiffness by density owes the account energy, whose drag
// comes by a tenth a tick, however long the steps are.
TEST(EffectsEnergy, TheForceIsContinuous) {
  for (const Effect effect : {kShading, kRecovery, kProcedural, kDensity, kStiffness}) {
    for (int lattice = 0; lattice < 3; ++lattice) {
      for (std::uint32_t seed = 1; seed <= 2; ++seed) {
        Cycle cycles[2];
        for (int fine = 0; fine < 2; ++fine) {
          Dice dice(500 + seed);
          const EnergyBody body = EnergyBody::plane(dice);
          const EnergyVolume volume(body, lattice, 0, seed);
          EffectParameters p;
          add(p, effect, dice, EnergyVolume::kSteepness * 3e-3);
          p.texture_wavelength_m = std::max(p.texture_wavelength_m, 1e-3);
          cycles[fine] = energyOf(volume, randomCycle(body, dice, fine == 0 ? 10e-6 : 5e-6), p, 1, 1000);
        }
        const double drag_N = EnergyAccount::kShare * EnergyAccount::kMostDrag * kEnergyStiffness * 4e-3;
        EXPECT_LE(cycles[1].largest_step_N, 0.55 * cycles[0].largest_step_N + (effect == kStiffness ? drag_N : 0))
            << kNames[effect] << " " << lattice;
      }
    }
  }
}

}  // namespace effects_energy_test
}  // namespace palpate
