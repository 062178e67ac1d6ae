// SPDX-License-Identifier: Apache-2.0
// apps/touch/run_notes.hpp: what a user may take for an error of the program, said in words: a force that is missing, a
// force that the encoders make rough, a setting that is cut off. Any thread.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/plan/scene.hpp"
#include "servo/loop/tick_record.hpp"

namespace palpate {

// The time in which the tool was in the object (density above `isovalue`) with no contact and no fault that says why,
// where it is at least kShortestSilence_s at a stretch. Of a run of records at `rate_hz`.
inline constexpr double kShortestSilence_s = 0.02;
[[nodiscard]] std::optional<std::string> noteOnSilence(std::span<const TickRecord> records, double isovalue,
                                                       double rate_hz, const std::string& algorithm);

// Steps of the encoders that change the force by kFeltStep_N or more: some hundredths of a newton are felt.
inline constexpr double kFeltStep_N = 0.1;
[[nodiscard]] std::optional<std::string> noteOnEncoders(const Scene& scene);

// A texture's amplitude that its wavelength cuts off.
[[nodiscard]] std::optional<std::string> noteOnTexture(const Scene& scene);

}  // namespace palpate
