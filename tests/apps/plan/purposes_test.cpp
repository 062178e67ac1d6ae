// SPDX-License-Identifier: Apache-2.0
// Whatever a run can be found to have has words: every kernel that the build embeds, every module beside the program.
#include "apps/plan/purposes.hpp"

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "engine/gpu/spirv_names.hpp"
#include "servo/contact/effects.hpp"
#include "shaders/kernels.hpp"

namespace palpate {
namespace purposes_test {

TEST(Purposes, AreThereForEveryKernel) {
  std::size_t kernels = 0;
  for (const auto& entry : std::filesystem::directory_iterator(PALPATE_SHADERS)) {
    if (entry.path().extension() != ".comp") continue;
    ++kernels;
    EXPECT_NE(kernelPurpose(entry.path().stem().string()), "") << entry.path();
  }
  EXPECT_GT(kernels, 20U);
  EXPECT_EQ(kernelPurpose("another"), "");
}

TEST(Purposes, AreThereForEveryModule) {
  std::vector<std::string> there;
  for (const auto& entry : std::filesystem::directory_iterator(PALPATE_MODULES))
    if (entry.path().stem() != "sample") there.push_back(entry.path().stem().string());  // that one is of a test
  std::sort(there.begin(), there.end());
  EXPECT_EQ(moduleNames(), there);
  for (const std::string& name : there) EXPECT_NE(modulePurpose(name), "") << name;
}

TEST(Purposes, OfWhatIsNotPalpatesOwnAreNone) {
  EXPECT_EQ(threadPurpose("llvmpipe-0"), "");
  EXPECT_EQ(threadPurpose("servo"), "the force, tick by tick");
  EXPECT_EQ(modulePurpose("libc"), "");
  EXPECT_EQ(bufferPurpose("nothing like it"), "");
}

TEST(Purposes, AreThereForEveryConstant) {
  std::size_t constants = 0;
  for (const auto& entry : std::filesystem::directory_iterator(PALPATE_SHADERS)) {
    if (entry.path().extension() != ".comp") continue;
    for (const auto& [id, name] : gpu::constantNames(kernelSpirv(entry.path().stem().string()))) {
      ++constants;
      EXPECT_NE(constantPurpose(name), "") << name;
    }
  }
  EXPECT_GT(constants, 20U);
}

// All of them, as the servo names them.
TEST(Purposes, AreThereForEveryEffect) {
  const std::string names = contactEffectNames({.force_shading = true,
                                                .recovery_s = 1,
                                                .texture = TextureKind::kProcedural,
                                                .friction = {.static_ratio = 1},
                                                .stiffness_by_density = {{0, 1}, {1, 1}}});
  std::size_t effects = 0;
  for (std::size_t at = 0; at < names.size(); ++effects) {
    const std::size_t end = std::min(names.find(", ", at), names.size());
    EXPECT_NE(effectPurpose(names.substr(at, end - at)), "") << names;
    at = end + 2;
  }
  EXPECT_EQ(effects, 5U);
}

// The more special row comes first.
TEST(Purposes, TellLongerNamesFromTheirBeginnings) {
  EXPECT_NE(kernelPurpose("gradient_smoothed"), kernelPurpose("gradient"));
  EXPECT_EQ(kernelPurpose("gradient_sobel"), kernelPurpose("gradient"));
  EXPECT_NE(kernelPurpose("edit_stencil"), kernelPurpose("edit"));
}

}  // namespace purposes_test
}  // namespace palpate
