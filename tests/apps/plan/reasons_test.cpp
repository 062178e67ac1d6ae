// SPDX-License-Identifier: Apache-2.0
// Whatever a run can be found to have has words: every kernel that the build embeds, every module beside the program.
#include "apps/plan/reasons.hpp"

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>

namespace palpate {
namespace reasons_test {

TEST(Reasons, AreThereForEveryKernel) {
  std::size_t kernels = 0;
  for (const auto& entry : std::filesystem::directory_iterator(PALPATE_SHADERS)) {
    if (entry.path().extension() != ".comp") continue;
    ++kernels;
    EXPECT_NE(kernelReason(entry.path().stem().string()), "") << entry.path();
  }
  EXPECT_GT(kernels, 20U);
  EXPECT_EQ(kernelReason("another"), "");
}

TEST(Reasons, AreThereForEveryModule) {
  std::vector<std::string> there;
  for (const auto& entry : std::filesystem::directory_iterator(PALPATE_MODULES))
    if (entry.path().stem() != "sample") there.push_back(entry.path().stem().string());  // that one is of a test
  std::sort(there.begin(), there.end());
  EXPECT_EQ(moduleNames(), there);
  for (const std::string& name : there) EXPECT_NE(moduleReason(name), "") << name;
}

TEST(Reasons, OfWhatIsNotPalpatesOwnAreNone) {
  EXPECT_EQ(threadReason("llvmpipe-0"), "");
  EXPECT_EQ(threadReason("servo"), "the force, tick by tick");
  EXPECT_EQ(moduleReason("libc"), "");
  EXPECT_EQ(bufferReason("nothing like it"), "");
}

// The more special row comes first.
TEST(Reasons, TellLongerNamesFromTheirBeginnings) {
  EXPECT_NE(kernelReason("gradient_smoothed"), kernelReason("gradient"));
  EXPECT_EQ(kernelReason("gradient_sobel"), kernelReason("gradient"));
  EXPECT_NE(kernelReason("edit_stencil"), kernelReason("edit"));
}

}  // namespace reasons_test
}  // namespace palpate
