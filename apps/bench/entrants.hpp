// SPDX-License-Identifier: Apache-2.0
// apps/bench/entrants.hpp: the algorithms that take part in `palpate bench servo`: each of the registry, with each n.
//
// Only this file of the bench makes algorithms. If a new one needs more for that, add it here. Set-up only.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "apps/bench/bench_volume.hpp"
#include "servo/algorithms/registry.hpp"

namespace palpate {

inline constexpr double kBenchStiffness_N_per_m = 500;
inline constexpr double kBenchForceLimit_N = 8;  // of the simulated device
inline constexpr double kBenchRate_hz = 1000;

inline constexpr const char* kRecoveryChoice = "recovery";
inline constexpr double kRecoveryTime_s = 0.02;

struct Entrant {
  std::string algorithm;
  int n = 1;
  std::string effects = "none";  // or kRecoveryChoice
  std::unique_ptr<Algorithm> haptic;
  AlgorithmTraits traits = {};
};

struct Entrants {
  std::vector<Entrant> list;               // algorithm by algorithm in the registry's order, n by n
  std::vector<std::string> left_out = {};  // "NAME: why", for algorithms that cannot be made for this volume
};

// One algorithm. There is no damping (B = 0), so the exact force is K * depth. Throws Error(kBadInput) as makeAlgorithm
// does.
[[nodiscard]] Entrant makeEntrant(const BenchVolume& volume, const std::string& algorithm, int n,
                                  const std::string& effects = "none");

// Every algorithm with each n of `renewals` and each of the `effects` ("none" or kRecoveryChoice). An algorithm that
// does not support all of these effects is left out.
[[nodiscard]] Entrants makeEntrants(const BenchVolume& volume, const std::vector<int>& renewals,
                                    const std::vector<std::string>& effects = {"none"});

}  // namespace palpate
