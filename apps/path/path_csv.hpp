// SPDX-License-Identifier: Apache-2.0
// apps/path/path_csv.hpp: reads a recorded or hand-written path: a CSV file with the header time_s,x_m,y_m,z_m, or
// time_s,x_m,y_m,z_m,brush where the tool also edits.
//
// World frame [m], seconds. Set-up code, any thread. Cost: one pass over the file, which is held in memory.
#pragma once

#include <filesystem>
#include <vector>

#include "apps/path/timed_point.hpp"

namespace palpate {

struct PathFile {
  std::vector<TimedPoint> points;
  std::vector<HeldBrush> brushes;  // one for each change, the first not empty
};

// The rows of `file`, in order. A brush is not looked into. Lines may end in CR LF; empty lines are skipped; numbers
// use '.' in every locale. Throws Error with file and line: kNotFound for a missing file; kIo for one that cannot be
// read; kBadInput for another header, fewer than two rows, a row that is not four numbers (and a brush), NaN or
// infinity (in the total time too), time that repeats or goes back, and a gap of more than ten times the median
// interval.
[[nodiscard]] PathFile readPathFile(const std::filesystem::path& file);
[[nodiscard]] std::vector<TimedPoint> readPathCsv(const std::filesystem::path& file);  // the points alone

}  // namespace palpate
