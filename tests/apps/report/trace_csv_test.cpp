// SPDX-License-Identifier: Apache-2.0
#include "apps/report/trace_csv.hpp"

#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

#include <gtest/gtest.h>

#include "sample_run.hpp"
#include "temporary_folder.hpp"

namespace palpate {
namespace trace_csv_test {

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> parts;
  std::istringstream in(line);
  for (std::string part; std::getline(in, part, ',');) parts.push_back(part);
  return parts;
}

TickRecord awkwardRecord() {
  TickRecord r;
  r.tick = 123456789012;
  r.time_s = 0.1 + 0.2;
  r.hip_W[0] = -1.0 / 3;
  r.hip_W[1] = std::numeric_limits<double>::denorm_min();
  r.hip_W[2] = std::numeric_limits<double>::max();
  r.vhip_W[0] = 1e-3;
  r.normal_W[1] = -1;
  r.force_W[2] = 0.6;
  r.density = 1.1F;
  r.in_contact = true;
  r.plane_age_ticks = 4;
  r.window_version = std::numeric_limits<std::uint64_t>::max();
  r.faults = 0xFFFFFFFF;
  r.tick_cost_ns = 2112;
  r.energy_J = -1.0 / 7;
  r.edit_version = std::numeric_limits<std::uint64_t>::max() - 1;
  return r;
}

TEST(TraceCsv, HasTheHeaderToTheLetter) {
  TemporaryFolder folder;
  writeTraceCsv(folder.path() / "t.csv", {});
  EXPECT_EQ(contentsOf(folder.path() / "t.csv"),
            "tick,time_s,hip_x_m,hip_y_m,hip_z_m,vhip_x_m,vhip_y_m,vhip_z_m,"
            "normal_x,normal_y,normal_z,force_x_n,force_y_n,force_z_n,"
            "density,in_contact,plane_age_ticks,window_version,faults,tick_cost_ns,energy_J,edit_version\n");
}

TEST(TraceCsv, NumbersReadBackToTheSameBits) {
  TemporaryFolder folder;
  const TickRecord r = awkwardRecord();
  writeTraceCsv(folder.path() / "t.csv", {r});
  std::istringstream in(contentsOf(folder.path() / "t.csv"));
  std::string line;
  std::getline(in, line);
  std::getline(in, line);
  const auto cell = split(line);
  ASSERT_EQ(cell.size(), 22U);
  EXPECT_EQ(cell[0], "123456789012");
  EXPECT_EQ(std::strtod(cell[1].c_str(), nullptr), r.time_s);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(std::strtod(cell[2 + i].c_str(), nullptr), r.hip_W[i]);
    EXPECT_EQ(std::strtod(cell[5 + i].c_str(), nullptr), r.vhip_W[i]);
    EXPECT_EQ(std::strtod(cell[8 + i].c_str(), nullptr), r.normal_W[i]);
    EXPECT_EQ(std::strtod(cell[11 + i].c_str(), nullptr), r.force_W[i]);
  }
  EXPECT_EQ(cell[5], "0.001");  // shortest
  EXPECT_EQ(cell[14], "1.1");
  EXPECT_EQ(cell[15], "1");
  EXPECT_EQ(cell[16], "4");
  EXPECT_EQ(cell[17], "18446744073709551615");
  EXPECT_EQ(cell[18], "4294967295");
  EXPECT_EQ(cell[19], "2112");
  EXPECT_EQ(std::strtod(cell[20].c_str(), nullptr), r.energy_J);
  EXPECT_EQ(cell[21], "18446744073709551614");
}

TEST(TraceCsv, UnknownDensityIsNanWhateverItsSign) {
  TemporaryFolder folder;
  TickRecord r;
  r.density = -std::numeric_limits<float>::quiet_NaN();
  writeTraceCsv(folder.path() / "t.csv", {r});
  EXPECT_NE(contentsOf(folder.path() / "t.csv").find(",nan,0,"), std::string::npos);
}

// Whoever reads the trace alone must not take it for the whole run.
TEST(TraceCsv, SaysThatItWasEndedEarlyInItsLastLine) {
  TemporaryFolder folder;
  const auto records = sampleRecords(3, 1000);
  writeTraceCsv(folder.path() / "whole.csv", records);
  writeTraceCsv(folder.path() / "t.csv", records, "stopped by the user after 0.003 s of 5 s");
  EXPECT_EQ(contentsOf(folder.path() / "t.csv"),
            contentsOf(folder.path() / "whole.csv") + "# stopped by the user after 0.003 s of 5 s\n");
}

TEST(TraceCsv, EqualRecordsGiveEqualBytes) {
  TemporaryFolder folder;
  const auto records = sampleRecords(3000, 1000);
  writeTraceCsv(folder.path() / "a.csv", records);
  writeTraceCsv(folder.path() / "b.csv", records);
  const std::string a = contentsOf(folder.path() / "a.csv");
  EXPECT_EQ(a, contentsOf(folder.path() / "b.csv"));
  EXPECT_EQ(std::count(a.begin(), a.end(), '\n'), 3001);
}

// A request to stop, say, in the middle of a long trace: no part of it stays.
TEST(TraceCsv, IsGivenUpInBetween) {
  TemporaryFolder folder;
  const auto records = sampleRecords(30'000, 1000);
  int calls = 0;
  writeTraceCsv(folder.path() / "a.csv", records, "", [&] { ++calls; });
  EXPECT_EQ(calls, 8);  // once every 4096 rows
  const auto third = [left = 3]() mutable {
    if (--left == 0) throw std::runtime_error("stop");
  };
  EXPECT_THROW(writeTraceCsv(folder.path() / "b.csv", records, "", third), std::runtime_error);
  EXPECT_EQ(folder.files(), 1);
  writeTraceCsv(folder.path() / "plain.csv", records);
  EXPECT_EQ(contentsOf(folder.path() / "a.csv"), contentsOf(folder.path() / "plain.csv"));
}

}  // namespace trace_csv_test
}  // namespace palpate
