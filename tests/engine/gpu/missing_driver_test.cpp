// SPDX-License-Identifier: Apache-2.0
// A machine without a Vulkan driver gets a message that names the package to install.
#include <cstdlib>

#include <gmock/gmock.h>

#include "base/error.hpp"
#include "engine/gpu/gpu.hpp"

namespace palpate::gpu {
namespace missing_driver_test {

TEST(MissingDriver, IsSaidWithThePackageToInstall) {
  // The loader then finds no driver manifest, as on a machine without any.
  setenv("VK_DRIVER_FILES", "/nonexistent/icd.json", 1);
  setenv("VK_ICD_FILENAMES", "/nonexistent/icd.json", 1);
  for (const auto& work : {+[] { (void)listGpus(); }, +[] { Gpu gpu({}); }}) {
    try {
      work();
      FAIL() << "no error";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Error::Code::kNotFound);
      EXPECT_THAT(error.what(), testing::HasSubstr("mesa-vulkan-drivers"));
    }
  }
}

}  // namespace missing_driver_test
}  // namespace palpate::gpu
