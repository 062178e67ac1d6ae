// SPDX-License-Identifier: Apache-2.0
// A kind of device for each row of the tuning table, for tests of every row.
#pragma once

#include <string>

#include "engine/passes/tuning.hpp"

namespace palpate {

// GpuRequest::tuned_as, and a test's name. The row for all others serves discrete devices too.
inline std::string deviceOf(const Tuning& row) {
  return row.device.empty() ? "discrete" : std::string(row.device);
}

}  // namespace palpate
