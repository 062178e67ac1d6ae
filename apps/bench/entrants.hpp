// SPDX-License-Identifier: Apache-2.0
// apps/bench/entrants.hpp: who takes part in `palpate bench servo`: every algorithm of the registry, by every n.
//
// The one place of the bench that makes algorithms: whatever a new one needs for its making is added here. Set-up only.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "apps/bench/bench_volume.hpp"
#include "servo/algorithms/registry.hpp"

namespace palpate {

inline constexpr double kBenchStiffness_N_per_m = 500;
inline constexpr double kBenchForceLimit_N = 8;  // of the simulated device
inline constexpr double kBenchRate_hz = 1000;

// Contact effects that are compared with none. A new choice is a row in entrants.cpp.
struct EffectChoice {
  std::string name;
  ContactEffects (*make)();
};
// The first is "none".
[[nodiscard]] std::span<const EffectChoice> effectChoices();

struct Entrant {
  std::string algorithm;
  int n = 1;
  std::string effects = "none";
  std::unique_ptr<Algorithm> haptic;
  AlgorithmTraits traits = {};
};

struct Entrants {
  std::vector<Entrant> list;               // algorithm by algorithm in the registry's order, n by n
  std::vector<std::string> left_out = {};  // "NAME: why", for algorithms that cannot be made for this volume
};

// Without effects. No damping (B = 0): the exact force is then K * depth alone, for every algorithm.
[[nodiscard]] Entrants makeEntrants(const BenchVolume& volume, const std::vector<int>& renewals);

// The algorithms that take them, with each choice of effects, "none" among them. Empty while there is no other choice.
[[nodiscard]] std::vector<Entrant> makeEntrantsWithEffects(const BenchVolume& volume, int n);

}  // namespace palpate
