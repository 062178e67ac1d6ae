// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/servo_run.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "servo/loop/tick_record.hpp"

namespace palpate {
namespace servo_run_test {

std::string refusal(const Scene& scene, std::uint64_t available_bytes) {
  try {
    checkRunLength(scene, available_bytes);
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

// 2 s at 500 Hz are 1000 records, twice.
TEST(RunLength, NeedsMemoryForItsRecordsTwice) {
  Scene scene;
  scene.duration_s = 2;
  scene.rate_hz = 500;
  const std::uint64_t needed = 2000 * sizeof(TickRecord);
  EXPECT_EQ(recordBytes(scene), static_cast<double>(needed));
  EXPECT_EQ(refusal(scene, needed), "");
  EXPECT_THAT(refusal(scene, needed - 1), testing::StartsWith("--seconds 2 at --rate 500: a run of 2 s records 1e+03"));
}

TEST(RunLength, SaysHowMuchItNeedsAndHasInGiB) {
  Scene scene;
  scene.duration_s = 1e6;
  scene.rate_hz = 1000;
  const double needed_GiB = 2e9 * sizeof(TickRecord) / (1024.0 * 1024 * 1024);
  EXPECT_EQ(refusal(scene, std::uint64_t{3} << 30U),
            fmt::format("--seconds 1e+06 at --rate 1000: a run of 1e+06 s records 1e+09 ticks, "
                        "which need {:.3g} GiB, and 3 GiB are free; make it shorter or the rate lower",
                        needed_GiB));
}

TEST(RunLength, HasATickAtLeast) {
  Scene scene;
  scene.duration_s = 0.04;
  scene.rate_hz = 10;
  EXPECT_THAT(refusal(scene, 1U << 30U), testing::HasSubstr("the run has no tick; make it longer"));
  scene.duration_s = 0.05;  // half a tick is one
  EXPECT_EQ(refusal(scene, 1U << 30U), "");
  scene.path_file = "way.csv";
  scene.duration_s = 0;
  EXPECT_THAT(refusal(scene, 1U << 30U), testing::StartsWith("way.csv at --rate 10: the run has no tick"));
}

}  // namespace servo_run_test
}  // namespace palpate
