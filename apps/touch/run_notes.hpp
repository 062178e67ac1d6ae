// SPDX-License-Identifier: Apache-2.0
// apps/touch/run_notes.hpp: notes that explain what a user may take for an error of the program: a missing force, a
// force that the encoders make rough, a setting that is clamped. Any thread.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/path/timed_point.hpp"
#include "apps/scene/scene.hpp"
#include "servo/devices/device.hpp"
#include "servo/loop/run_figures.hpp"
#include "servo/loop/tick_record.hpp"

namespace palpate {

// A note on the time that the tool spent inside the object (density above `isovalue`) without contact and without a
// fault that explains it. Counts stretches of at least kShortestSilence_s; empty if there is none. `rate_hz` of the
// records.
inline constexpr double kShortestSilence_s = 0.02;
[[nodiscard]] std::optional<std::string> noteOnSilence(std::span<const TickRecord> records, double isovalue,
                                                       double rate_hz, const std::string& algorithm);

// A note if one step of the encoders changes the force by kFeltStep_N or more. A person feels some hundredths of a
// newton.
inline constexpr double kFeltStep_N = 0.1;
[[nodiscard]] std::optional<std::string> noteOnEncoders(const Scene& scene, const DeviceLimits& device);

// A note if something was touched, but never deep enough for a force of kFaintForce_N (apps/report/words.hpp), as in an
// object of some micrometres. The note says how deep, and which stiffness would do. `scene`: as the user gave it.
[[nodiscard]] std::optional<std::string> noteOnFaintForce(const Scene& scene, const RunFigures& figures);

// A note if nothing was touched and no fault explains it. `ended_early`: the tool did not reach the end of its path.
[[nodiscard]] std::optional<std::string> noteOnNoContact(const RunFigures& figures, bool ended_early, bool has_path);

// A note if a spring hand pressed less deep than `scene`, as the user gave it, asks for, by more than kDepthShare of
// that depth. The hand's spring and the surface's spring share the displacement. `phases`: the phases that the tool
// reached; before the slide the press is not complete.
inline constexpr double kDepthShare = 0.1;
[[nodiscard]] std::optional<std::string> noteOnHand(const Scene& scene, const RunFigures& figures,
                                                    std::span<const PathPhase> phases);

// A note if a brush removes at once all that it touches, so that the tool is out of contact for more than half of the
// time after it touched first.
[[nodiscard]] std::optional<std::string> noteOnBrush(const Scene& scene, const RunFigures& figures);

// A note if the texture's wavelength allows less than the amplitude that was asked for.
[[nodiscard]] std::optional<std::string> noteOnTexture(const Scene& scene);

}  // namespace palpate
