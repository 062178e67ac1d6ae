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
        Words{"render", "phantom:sphere?size=16", "-o", "o.png"},
        Words{"check", "gradient", "phantom:sphere?size=16"}}) {
    expectRefusal(withoutDriver(words), "Vulkan", "mesa-vulkan-drivers", 3);
  }
  EXPECT_FALSE(exists("out"));
  EXPECT_FALSE(exists("o.png"));
}

TEST_F(MissingDriver, DoesNotStopWhatNeedsNone) {
  expectSuccess(withoutDriver({"info", "phantom:sphere?size=16"}));
  expectSuccess(withoutDriver({"scene"}));
}

// What cannot be written is said first: without a driver, so before Vulkan is asked for.
TEST_F(MissingDriver, IsSaidAfterAnOutputThatCannotBeWritten) {
  const std::string sphere = "phantom:sphere?size=16";
  for (const Words& words :
       {Words{"check", "gradient", sphere, "--json"}, Words{"check", "filters", sphere, "--json"},
        Words{"check", "edits", sphere, "--json"}, Words{"check", "all", sphere, "--json"},
        Words{"check", "all", sphere, "--page"}, Words{"bench", "edit", "--quick", "--json"},
        Words{"bench", "filters", "--quick", "--csv"}, Words{"bench", "gradient", "--quick", "--chart"},
        Words{"bench", "loop", "--quick", "--page"}, Words{"gradient", sphere, "--out"},
        Words{"filter", sphere, "--filter", "median:1", "--out"}}) {
    expectRefusal(withoutDriver(words + Words{"nowhere/a.vdb"}), "nowhere/a.vdb", "cannot be created", 4);
  }
}

}  // namespace missing_driver_test
}  // namespace palpate
