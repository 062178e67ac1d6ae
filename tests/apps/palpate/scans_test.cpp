// SPDX-License-Identifier: Apache-2.0
// The whole program on a real scan, where one is at hand (PALPATE_DATA).
#include "tests/support/scans.hpp"

#include <cstdlib>

#include <nlohmann/json.hpp>

#include "program_test.hpp"

namespace palpate {
namespace scans_test {

class Scans : public ProgramTest {
 protected:
  void SetUp() override {
    const char* data = std::getenv("PALPATE_DATA");
    if (data == nullptr) GTEST_SKIP() << kNoScans;
    scan_ = std::string(data) + "/ct_head_headsq.nrrd";
    if (!std::filesystem::exists(scan_)) GTEST_SKIP() << scan_ << " is not there";
  }
  std::string scan_;
};

TEST_F(Scans, HeadIsFelt) {
  expectSuccess(run(quickTouch(scan_)));
  const auto summary = nlohmann::json::parse(contentsOf(file("out/summary.json")));
  EXPECT_GT(summary["contact"]["ticks"], 100);
  EXPECT_EQ(summary["faults"].size(), 0U) << summary["faults"];
}

// The second holds the voxels of the demo's scan.
TEST_F(Scans, GradientsOfHeadsAgreeBitForBit) {
  for (const char* name : {"ct_head_headsq.nrrd", "ct_head_invesalius.nrrd"}) {
    const auto scan = std::filesystem::path(scan_).replace_filename(name);
    if (!std::filesystem::exists(scan)) GTEST_SKIP() << scan << " is not there";
    const Outcome outcome = run({"check", "gradient", scan.string()});
    expectSuccess(outcome);
    EXPECT_THAT(outcome.out, testing::ContainsRegex("differing values +0\n")) << name;
  }
}

// Gradients, filters and edits of every scan; the middle alone, since the twins go voxel by voxel.
TEST_F(Scans, AllChecksHoldInTheMiddle) {
  for (const auto& scan : realScans()) {
    const Outcome outcome = run({"check", "all", scan.string(), "--quick", "--crop", "32"});
    EXPECT_EQ(outcome.status, 0);
    // A micro-CT is as small as a head whose metres were taken for millimetres, and that is told.
    EXPECT_THAT(errorLines(outcome.err), testing::Each(testing::HasSubstr("mm long")));
    EXPECT_THAT(outcome.out, testing::HasSubstr("its middle 32 x 32 x 32 voxels"));
    EXPECT_THAT(outcome.out, testing::Not(testing::HasSubstr("BROKEN")));
  }
}

}  // namespace scans_test
}  // namespace palpate
