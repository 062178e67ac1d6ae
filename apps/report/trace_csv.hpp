// SPDX-License-Identifier: Apache-2.0
// apps/report/trace_csv.hpp: writes trace.csv: one row a tick, world frame, units in the column names.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "servo/loop/tick_record.hpp"

namespace palpate {

inline constexpr std::string_view kTraceHeader =
    "tick,time_s,hip_x_m,hip_y_m,hip_z_m,vhip_x_m,vhip_y_m,vhip_z_m,"
    "normal_x,normal_y,normal_z,force_x_n,force_y_n,force_z_n,"
    "density,in_contact,plane_age_ticks,window_version,faults,tick_cost_ns,energy_J,edit_version";

// Each number is the shortest text that reads back to the same bits, so equal records give equal bytes. The density is
// "nan" where the window did not reach. Throws Error kIo (atomic_file.hpp). Any thread. Cost: about 2 microseconds and
// 200 bytes a row.
// `ended_early`: for a run that was stopped; written as a last line "# ...". A reader that knows no comments must skip
// it. `between` is called every few thousand rows, and may throw to cancel.
void writeTraceCsv(const std::filesystem::path& file, const std::vector<TickRecord>& records,
                   const std::string& ended_early = "", const std::function<void()>& between = {});

}  // namespace palpate
