// SPDX-License-Identifier: Apache-2.0
#include "apps/tune/tune_job.hpp"

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
}

}  // namespace tune_job_test
}  // namespace palpate
