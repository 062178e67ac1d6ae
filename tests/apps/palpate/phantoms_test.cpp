// SPDX-License-Identifier: Apache-2.0
// The whole program on every phantom whose surface is known exactly: rigid hand, the plane found again at every tick.
#include <cstdio>

#include <nlohmann/json.hpp>

#include "engine/volume/phantom_spec.hpp"
#include "program_test.hpp"

namespace palpate {
namespace {

using Json = nlohmann::json;

Words kinds() {
  Words names;
  for (const PhantomKind& kind : phantomKinds()) {
    if (kind.name != "random") names.push_back(kind.name);  // which has no surface
  }
  return names;
}

class Phantoms : public ProgramTest, public testing::WithParamInterface<std::string> {
 protected:
  [[nodiscard]] Json touch(const std::string& volume) const {
    expectSuccess(run(quickTouch(volume, {"--n", "1"})));
    return Json::parse(contentsOf(file("out/summary.json")));
  }
};

// A wall is made thick enough that the press of 1 mm stays in its outer half: at its middle the nearest surface, and
// with it the exact normal, changes sides. The figures of all are printed, so that a log shows them.
TEST_P(Phantoms, AreFeltWithoutAFault) {
  const Json summary = touch("phantom:" + GetParam() + "?size=64" + (GetParam() == "shell" ? "&thickness=5" : ""));
  EXPECT_GT(summary["contact"]["ticks"], 100);
  EXPECT_EQ(summary["faults"].size(), 0U) << summary["faults"];
  ASSERT_FALSE(summary["exact"].is_null());
  const auto figure = [&](const char* key) { return summary["exact"][key].get<double>(); };
  std::printf("%-8s 64^3, n 1: VHIP off by %.4f voxel median, %.4f p99; force by %.3f degrees median, %.3f p99\n",
              GetParam().c_str(), figure("vhip_median_voxel"), figure("vhip_p99_voxel"),
              figure("force_angle_median_deg"), figure("force_angle_p99_deg"));
  // A sampled surface of curvature radius R lies off by about h^2 / (8 R) for each of two directions: with R of 2.5
  // voxels or more (the knot's tube, the head's and the lung's bodies are thicker) a tenth of a voxel; the angle is off
  // by that over the distance of a voxel, some 6 degrees.
  EXPECT_LT(figure("vhip_median_voxel"), 0.1);
  EXPECT_LT(figure("force_angle_median_deg"), 6);
}

INSTANTIATE_TEST_SUITE_P(Each, Phantoms, testing::ValuesIn(kinds()), [](const auto& kind) { return kind.param; });

// Figures that the program promises.
TEST_F(Phantoms, SphereKeepsThePromisedAccuracy) {
  const Json exact = touch("phantom:sphere?size=64")["exact"];
  EXPECT_LE(exact["vhip_median_voxel"], 0.01);
  EXPECT_LE(exact["force_angle_median_deg"], 0.2);
}

}  // namespace
}  // namespace palpate
