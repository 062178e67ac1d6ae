// SPDX-License-Identifier: Apache-2.0
// apps/touch/run_length.hpp: refuses runs that are too short, or too long for the memory. Any thread.
#pragma once

#include <cstdint>

#include "apps/scene/scene.hpp"

namespace palpate {

// Memory for the records of a scene's run [byte]. It counts them twice, since making the report needs a copy.
[[nodiscard]] double recordBytes(const Scene& scene);

// Throws Error, which names the flags or the path's file: kBadInput for a run without a tick, kOutOfMemory if the
// records do not fit into `available_bytes`.
void checkRunLength(const Scene& scene, std::uint64_t available_bytes);

}  // namespace palpate
