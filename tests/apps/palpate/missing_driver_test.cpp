// SPDX-License-Identifier: Apache-2.0
// A machine without a Vulkan driver: every verb that needs one names the package to install.
#include "program_test.hpp"

namespace palpate {
namespace missing_driver_test {

class MissingDriver : public ProgramTest {
 protected:
  // The loader then finds no driver manifest, as on a machine without any.
  [[nodiscard]] Outcome withoutDriver(const Words& arguments) const {
    return runPalpate(
        {.arguments = arguments,
         .folder = folder(),
         .environment = {{"VK_DRIVER_FILES", "/nonexistent/icd.json"}, {"VK_ICD_FILENAMES", "/nonexistent/icd.json"}}});
  }
};

TEST_F(MissingDriver, IsSaidWithThePackageToInstall) {
  for (const Words& words :
       {quickTouch("phantom:sphere?size=16"), Words{"devices"}, Words{"plan", "phantom:sphere?size=16"},
        Words{"check", "gradient", "phantom:sphere?size=16"}}) {
    expectRefusal(withoutDriver(words), "Vulkan", "mesa-vulkan-drivers", 3);
  }
  EXPECT_FALSE(exists("out"));
}

TEST_F(MissingDriver, DoesNotStopWhatNeedsNone) {
  expectSuccess(withoutDriver({"info", "phantom:sphere?size=16"}));
  expectSuccess(withoutDriver({"scene"}));
}

}  // namespace missing_driver_test
}  // namespace palpate
