// SPDX-License-Identifier: Apache-2.0
// Reads trace.csv as a user's script would: by the header that the documentation promises.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "base/vec.hpp"
#include "temporary_folder.hpp"

namespace palpate {

inline constexpr const char* kTraceHeader =
    "tick,time_s,hip_x_m,hip_y_m,hip_z_m,vhip_x_m,vhip_y_m,vhip_z_m,"
    "normal_x,normal_y,normal_z,force_x_n,force_y_n,force_z_n,"
    "density,in_contact,plane_age_ticks,window_version,faults,tick_cost_ns,energy_J,edit_version";

struct TraceRow {
  std::vector<double> cells;
  [[nodiscard]] double tick() const { return cells[0]; }
  [[nodiscard]] double time_s() const { return cells[1]; }
  [[nodiscard]] Vec3 hip_W() const { return vector(2); }
  [[nodiscard]] Vec3 vhip_W() const { return vector(5); }
  [[nodiscard]] Vec3 normal_W() const { return vector(8); }
  [[nodiscard]] Vec3 force_N() const { return vector(11); }
  [[nodiscard]] bool inContact() const { return cells[15] == 1; }
  [[nodiscard]] double faults() const { return cells[18]; }
  [[nodiscard]] double editVersion() const { return cells[21]; }
  [[nodiscard]] double cost_ns() const { return cells[19]; }
  [[nodiscard]] double energy_J() const { return cells[20]; }

 private:
  [[nodiscard]] Vec3 vector(std::size_t first) const { return {cells[first], cells[first + 1], cells[first + 2]}; }
};

struct Trace {
  std::string header;
  std::vector<TraceRow> rows;
};

inline Trace readTrace(const std::filesystem::path& file) {
  std::istringstream in(contentsOf(file));
  Trace trace;
  std::getline(in, trace.header);
  for (std::string line; std::getline(in, line);) {
    TraceRow row;
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) row.cells.push_back(std::strtod(cell.c_str(), nullptr));
    row.cells.resize(std::max<std::size_t>(row.cells.size(), 22), -1);
    trace.rows.push_back(row);
  }
  return trace;
}

}  // namespace palpate
