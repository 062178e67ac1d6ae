// SPDX-License-Identifier: Apache-2.0
// Every algorithm of the registry through the program, with nothing but its name.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "program_test.hpp"
#include "servo/algorithms/registry.hpp"
#include "trace.hpp"

namespace palpate {
namespace algorithms_test {

class Algorithms : public ProgramTest {};

// On the way in and 1 mm deep into a ball, along its normal, which the path's own direction is.
TEST_F(Algorithms, EachGivesAForceOutwardOnceItIsInside) {
  for (const AlgorithmEntry& entry : algorithms()) {
    SCOPED_TRACE(std::string(entry.name));
    expectSuccess(run(quickTouch("phantom:sphere?size=32", {"--algorithm", std::string(entry.name)})));
    int pushed = 0;
    for (const TraceRow& row : readTrace(file("out/trace.csv")).rows) {
      EXPECT_EQ(row.faults(), 0) << row.tick();
      if (row.hip_W().norm() > 0 && row.force_N().dot(row.hip_W().normalized()) > 0.1) ++pushed;
    }
    EXPECT_GT(pushed, 150);  // press and slide are two thirds of 300 ticks
  }
}

// Gradients are computed in bricks of 8 voxels that the isosurface crosses, and in those above them. The ball's radius
// is 22.05 voxels, so that its lower pole is at index 9.45, in the second brick; the ramp of its density ends 3 voxels
// further out. The table pushes on its foot, at 2.5 voxels, in the first brick.
TEST_F(Algorithms, HaptizationFeelsAwayFromTheIsosurface) {
  write("way.csv", "time_s,x_m,y_m,z_m\n0,0,0,-0.027\n0.3,0,0,-0.02455\n");
  expectSuccess(run(quickTouchAlong(
      "way.csv", "phantom:sphere?size=64",
      {"--algorithm", "haptization", "--haptization-density", "-1000:0:0,-900:2:0", "--haptization-gradient", "0:1"})));
  const Trace trace = readTrace(file("out/trace.csv"));
  EXPECT_EQ(trace.rows.front().force_N().norm(), 0);
  EXPECT_NEAR(trace.rows.back().force_N().z(), -2, 0.01);
  const auto summary = nlohmann::json::parse(contentsOf(file("out/summary.json")));
  EXPECT_EQ(summary["scene"]["haptization"]["density"], nlohmann::json({{-1000, 0, 0}, {-900, 2, 0}}));
}

// docs/algorithms.md has the bound of every algorithm that keeps planes, as the registry gives it.
TEST_F(Algorithms, PlanesMayBeOffByWhatThePageSays) {
  PlaneAge age{.speed_m_per_s = 0.1, .curvature_per_m = 1 / (20e-3 - 1e-3), .depth_m = 1e-3, .voxel_m = 1e-3};
  std::string table = "| algorithm | n = 1 | n = 5 | n = 20 | n = 50 |\n|---|---:|---:|---:|---:|\n";
  for (const AlgorithmEntry& entry : algorithms()) {
    if (!entry.traits.renews_planes) continue;
    table += fmt::format("| `{}` |", entry.name);
    for (const int n : {1, 5, 20, 50}) {
      age.n = n;
      table += fmt::format(" {:.3g} |", 1e6 * entry.plane_age_error(age));
    }
    table += "\n";
  }
  EXPECT_NE(contentsOf(PALPATE_DOCS "/algorithms.md").find(table + "\n"), std::string::npos)
      << "docs/algorithms.md must hold:\n"
      << table;
}

}  // namespace algorithms_test
}  // namespace palpate
