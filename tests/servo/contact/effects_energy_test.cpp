// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "contact/energy_cycles.hpp"

namespace palpate {
namespace {

enum Effect { kShading, kRecovery, kProcedural, kDensity, kFriction, kStiffness, kEffects };
const char* const kNames[] = {"shading", "recovery", "procedural", "density", "friction", "stiffness"};

void add(EffectParameters& p, Effect effect, Dice& dice, double density_below) {
  switch (effect) {
    case kShading: p.force_shading = true; break;
    case kRecovery: p.recovery_s = dice.spread(1e-3, 1); break;
    case kProcedural:
    case kDensity:
      p.texture = effect == kProcedural ? TextureKind::kProcedural : TextureKind::kDensity;
      p.texture_amplitude_m = dice.spread(0.01e-3, 2e-3);
      p.texture_wavelength_m = dice.spread(0.3e-3, 20e-3);
      p.texture_gain = dice.spread(0.1, 100);
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
    case kEffects: break;
  }
}

TEST(Explore, Table) {
  for (const int n : {atoi(getenv("N"))}) {
    for (const double noise : {atof(getenv("NOISE"))}) {
      for (int a = -1; a < kEffects; ++a) {
        for (int b = a; b < kEffects; ++b) {
          if (a == -1 && b != -1) continue;
          if (a == kProcedural && b == kDensity) continue;
          if (getenv("SINGLE") && a != b) continue;
          std::string line;
          double worst = 0, step = 0;
          for (int body_kind = 0; body_kind < 4; ++body_kind) {
            double worst_here = 0; std::uint32_t at_seed = 0; int at_lat = 0;
            for (int lattice = 0; lattice < 3; ++lattice) {
              for (std::uint32_t seed = 1; seed <= 4; ++seed) {
                Dice dice(seed * 100 + static_cast<std::uint32_t>(body_kind));
                const EnergyBody body = body_kind == 0   ? EnergyBody::plane(dice)
                                        : body_kind == 3 ? EnergyBody::knot(dice)
                                                         : EnergyBody::ball(dice, body_kind == 2);
                static std::map<std::tuple<int, int, std::uint32_t, double>, std::unique_ptr<EnergyVolume>> cache;
                auto& volume = cache[{body_kind, lattice, seed, noise}];
                if (!volume)
                  volume = std::make_unique<EnergyVolume>(body, lattice, noise * (lattice ? 0.5e-3 : 1e-3), seed);
                EffectParameters p;
                const double below = EnergyVolume::kSteepness * (lattice == 0 ? 2.5e-3 : 3e-3);
                if (a >= 0) add(p, static_cast<Effect>(a), dice, below);
                if (b > a) add(p, static_cast<Effect>(b), dice, below);
                const double step_m =
                    std::min(0.02e-3, p.texture == TextureKind::kProcedural ? p.texture_wavelength_m / 40 : 1.0);
                const EnergyWay way = randomCycle(body, dice, step_m * (getenv("FAST") ? 5 : 1));
                const Cycle c = energyOf(*volume, way, p, n, 1000);
                const Cycle base = energyOf(*volume, way, {}, n, 1000);
                double times = 1; for (auto& r : p.stiffness_by_density) times = std::max(times, r.factor);
                const double share = (c.given_J - (getenv("RAW") ? 0 : times * base.given_J)) / c.stored_J;
                if (share > worst_here) worst_here = share, at_seed = seed, at_lat = lattice;
                step = std::max(step, c.largest_step_N * 1e3);
                if (c.lost > 40) line += fmt::format(" LOST{}", c.lost);
              }
            }
            line += fmt::format(" {:8.4f} ({},{})", worst_here, at_lat, at_seed);
            worst = std::max(worst, worst_here);
          }
          fmt::print("n {} noise {} {:10s} {:10s} {} step {:.1f} mN\n", n, noise, a < 0 ? "none" : kNames[a],
                     b == a ? "" : kNames[b], line, step);
        }
      }
    }
  }
}

}  // namespace
}  // namespace palpate
