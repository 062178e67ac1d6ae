// SPDX-License-Identifier: Apache-2.0
// apps/stability/stability_request.hpp: how much of the stability study is run, and how it tells its progress.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace palpate {

struct StabilityRequest {
  // Damping of the walls of part "limit", as shares of the damping that is stable without a wall.
  std::vector<double> limit_damping = {0, 0.02, 0.05, 0.1, 0.2, 0.4, 0.6, 0.8, 0.9, 0.97};
  bool every_hand = true;     // else the normal one
  bool every_delay = true;    // 0, 1 and 3 ticks, else the device's own
  bool every_variant = true;  // of part "width" for each device and hand, else for the default device alone
  std::vector<double> width_damping = {0, 0.5, 2, 5, 20};  // of part "width" [N s/m]
  int stiff_trials = 2000;
  std::uint64_t seed = 1;

  [[nodiscard]] static StabilityRequest quick() {
    return {.limit_damping = {0, 0.1, 0.6, 0.9},
            .every_hand = false,
            .every_delay = false,
            .every_variant = false,
            .width_damping = {0, 0.5, 5},
            .stiff_trials = 150};
  }
};

// Called with the share that is done; may throw to stop.
using StudyProgress = std::function<void(double done)>;

}  // namespace palpate
