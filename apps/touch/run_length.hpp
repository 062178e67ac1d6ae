// SPDX-License-Identifier: Apache-2.0
// apps/touch/run_length.hpp: whether a run is neither too short nor too long to be made. Any thread.
#pragma once

#include <cstdint>

#include "engine/plan/scene.hpp"

namespace palpate {

// What the records of a scene's run need, twice: they are worked on for the report [byte].
[[nodiscard]] double recordBytes(const Scene& scene);

// Throws Error, which names the flags or the path's file: kBadInput where there is no tick, kOutOfMemory where the
// records do not fit into `available_bytes`.
void checkRunLength(const Scene& scene, std::uint64_t available_bytes);

}  // namespace palpate
