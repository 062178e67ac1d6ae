// SPDX-License-Identifier: Apache-2.0
#include "apps/tune/tune_job.hpp"

#include <cstdio>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "temporary_folder.hpp"

namespace palpate {
namespace tune_job_test {

using testing::HasSubstr;

class TuneJobTest : public testing::Test {
 protected:
  [[nodiscard]] TuneRequest request() const {
    TuneRequest request;
    request.scene.volume = request.source = "phantom:sphere?size=24";
    request.scene.duration_s = 0.2;
    request.goal = {Goal::Kind::kError, 1};
    request.out = (folder_.path() / "tuned.toml").string();
    return request;
  }
  TemporaryFolder folder_;
  Progress quiet_ = Progress(nullptr);
};

// Nobody's hand may be moved by a search, and a device need not be there.
TEST_F(TuneJobTest, FeelsAnotherDevicesSceneWithTheSimulatedOne) {
  TuneRequest other = request();
  other.scene.device = "of somebody";
  const TuneResult result = tune(other, quiet_);
  EXPECT_TRUE(result.met);
  EXPECT_EQ(result.felt_how, "with the simulated device");
  EXPECT_THAT(result.notes, testing::Contains(HasSubstr("not with of somebody")));
  std::ostringstream text;
  text << std::ifstream(other.out).rdbuf();
  EXPECT_THAT(text.str(), HasSubstr("[device]\nname = \"of somebody\""));
}

TEST_F(TuneJobTest, SaysNothingOfTheUsualDevice) {
  const TuneResult result = tune(request(), quiet_);
  EXPECT_TRUE(result.met);
  EXPECT_EQ(result.felt_how, "");
  EXPECT_EQ(result.truth, "the exact surface of the phantom, without its noise");
  EXPECT_FALSE(result.device.empty());
}

// The error that the nearest choice has, with its margin, or a wall that is softer by the share that is missing.
TEST_F(TuneJobTest, SaysByHowMuchAnErrorIsMissed) {
  TuneRequest noisy = request();
  noisy.scene.volume = noisy.source = "phantom:sphere?size=24&noise=0.1";
  noisy.goal.bound = 0.02;
  const TuneResult result = tune(noisy, quiet_);
  ASSERT_FALSE(result.met);
  double error_N = 0, stiffness_N_per_m = 0;
  ASSERT_EQ(std::sscanf(result.needed.c_str(), "an error of %lf N, or a stiffness of at most %lf N/m", &error_N,
                        &stiffness_N_per_m),
            2)
      << result.needed;
  EXPECT_NEAR(error_N, result.chosen.error_N * kErrorMargin, 0.01 * error_N);  // told in three digits
  EXPECT_NEAR(stiffness_N_per_m, stiffnessOf(noisy.scene) * 0.02 / error_N, 0.01 * stiffness_N_per_m);
  EXPECT_THAT(result.needed, HasSubstr("a volume with less noise"));
}

}  // namespace tune_job_test
}  // namespace palpate
