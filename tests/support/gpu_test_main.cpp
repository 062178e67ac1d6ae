// SPDX-License-Identifier: Apache-2.0
// main() for tests that use Vulkan: the validation layer is on, and any message of it fails the test in which it came.
// One Gpu lives as long as the program, so that its tests share the kernels that they make.
#include <cstdlib>
#include <optional>

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "engine/gpu/gpu.hpp"
#include "engine/gpu/validation.hpp"
#include "tests/support/only_file.hpp"
#include "tests/support/tell_skipped.hpp"

namespace {

void failWithMessages() {
  for (const std::string& message : palpate::gpu::validationMessages())
    ADD_FAILURE() << "validation layer: " << message;
}

class ValidationListener : public testing::EmptyTestEventListener {
  void OnTestStart(const testing::TestInfo&) override { palpate::gpu::clearValidationMessages(); }
  void OnTestEnd(const testing::TestInfo&) override { failWithMessages(); }
};

class OpenGpu : public testing::Environment {
  void SetUp() override {
    try {
      gpu_.emplace(palpate::gpu::GpuRequest{});
    } catch (const palpate::Error&) {  // which the tests will say themselves
    }
  }
  // What was not destroyed is told when the device goes.
  void TearDown() override {
    palpate::gpu::clearValidationMessages();
    gpu_.reset();
    failWithMessages();
  }

  std::optional<palpate::gpu::Gpu> gpu_;
};

}  // namespace

int main(int argc, char** argv) {
  setenv("PALPATE_VALIDATION", "1", 1);
  testing::InitGoogleTest(&argc, argv);
  palpate::tellSkipped();
  if (!palpate::takeOnlyFile(argc, argv)) return 1;
  testing::UnitTest::GetInstance()->listeners().Append(new ValidationListener);
  testing::AddGlobalTestEnvironment(new OpenGpu);
  return RUN_ALL_TESTS();
}
