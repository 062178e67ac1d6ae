// SPDX-License-Identifier: Apache-2.0
// apps/tune/truth.hpp: the true surface point for each place of the tool: what the force's error is taken against.
//
// Two kinds. A phantom at its own isovalue has an exact surface, without noise. For anything else nothing exact is
// known: the truth is then what the same algorithm finds at the same places of the tool with the truest settings that
// keep filter and operator (n = 1, floats, the largest window). One thread.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/touch/force_error.hpp"

namespace palpate {

class Truth {
 public:
  virtual ~Truth() = default;
  // The true points for a run's records, one for each; empty where none is known. Kept for runs of the same places.
  [[nodiscard]] const std::vector<std::optional<TruePoint>>& pointsOf(const std::vector<TickRecord>& records);

 private:
  [[nodiscard]] virtual std::vector<std::optional<TruePoint>> find(const std::vector<TickRecord>& records) = 0;
  std::vector<Vec3> places_W_;
  std::vector<std::optional<TruePoint>> points_;
};

[[nodiscard]] std::unique_ptr<Truth> exactTruth(const std::string& phantom);

// `felt`: the records of a run of the truest settings along the places of another run.
using FeelAlong = std::function<std::vector<TickRecord>(const std::vector<TickRecord>& records)>;
[[nodiscard]] std::unique_ptr<Truth> feltTruth(FeelAlong felt);

// The error of a run.
struct RunErrors {
  // Over the ticks of forceErrors(); NaN: no tick has a known error.
  double p99_N = std::numeric_limits<double>::quiet_NaN();
  double contact_share = 0;  // ticks of these in contact, of all of the slide; of the run, where it has no slide [-]
};
[[nodiscard]] RunErrors runErrors(Truth& truth, const std::vector<TickRecord>& records,
                                  const std::vector<PathPhase>& phases, double stiffness_N_per_m);

// Why nothing exact is known of a scene; empty if something is: its volume is a phantom with a surface, felt at the
// phantom's own isovalue, alone. `isovalue`: that is felt.
[[nodiscard]] std::string whyNotExact(const Scene& scene, double isovalue);

}  // namespace palpate
