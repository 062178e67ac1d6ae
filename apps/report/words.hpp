// SPDX-License-Identifier: Apache-2.0
// apps/report/words.hpp: a run in words: a sentence for a heading, some lines for a terminal, numbers with units.
//
// Screen units (mm, N, us, MiB). Any thread; a few microseconds once the figures are there.
#pragma once

#include <cstdint>
#include <string>

#include "apps/report/touch_run.hpp"
#include "servo/loop/run_figures.hpp"

namespace palpate {

// Below it nobody feels a force: a person feels some hundredths of a newton.
inline constexpr double kFaintForce_N = 0.05;

// "The tool touched the surface for 3.1 s of 5 s, pressed at most 1.2 mm deep and felt at most 0.6 N; the contact was
// quiet; 9 edits removed 3.4 mm3; no fault." Where all forces were faint it says that none above 0.05 N was reached.
[[nodiscard]] std::string verdict(const TouchRun& run, const RunFigures& figures);

// About ten lines, each ending in a newline: what was touched, how it felt, energy, how the servo did, faults, files.
[[nodiscard]] std::string closingSummary(const TouchRun& run);

// For a run with --save: how often the volume was saved, up to which edit, its size, the time, what failed.
[[nodiscard]] std::string saveWords(const TouchRun& run);

// The verdict on the contact (servo/loop/contact_stability.hpp) with its figures and, if something should be changed,
// advice: "quiet: the surface took 0.3 mJ from the hand, and no contact gave more than it had taken".
[[nodiscard]] std::string stabilityWords(const ContactStability& stability, const RunFigures& figures);

// For a run with edits: "removed about 12.3 mm3", "added about 4.5 mm3", "moved no voxel across the surface"; empty if
// unknown.
[[nodiscard]] std::string volumeChange(const RunEdits& edits);

// "1 edit", "3 edits"
[[nodiscard]] std::string counted(std::uint64_t count, const std::string& word);

// Ticks that the servo left out after late ones: ", 12 left out"; empty if none.
[[nodiscard]] std::string leftOutWords(const RunFigures& figures);

// Three significant digits: 0.123, 12.3, 123, 1234 (never fewer than the integer has). Halves are rounded away from
// zero.
[[nodiscard]] std::string shortNumber(double value);
[[nodiscard]] std::string faultWord(std::size_t count);  // "no fault", "1 kind of fault", "3 kinds of fault"

}  // namespace palpate
