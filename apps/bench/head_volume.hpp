// SPDX-License-Identifier: Apache-2.0
// apps/bench/head_volume.hpp: the CT head that benches measure on, where this machine has one. Any thread.
#pragma once

#include <string>

namespace palpate {

// Its name, as loadVolume takes it: the demo's scan, else the scan in PALPATE_DATA, else a phantom.
[[nodiscard]] std::string headVolume();

}  // namespace palpate
