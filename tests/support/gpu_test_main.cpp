// SPDX-License-Identifier: Apache-2.0
// main() for tests that use Vulkan: the validation layer is on, and any message of it fails the test in which it came.
#include <cstdlib>

#include <gtest/gtest.h>

#include "engine/gpu/validation.hpp"

namespace {

class ValidationListener : public testing::EmptyTestEventListener {
  void OnTestStart(const testing::TestInfo&) override { palpate::gpu::clearValidationMessages(); }
  void OnTestEnd(const testing::TestInfo&) override {
    for (const std::string& message : palpate::gpu::validationMessages())
      ADD_FAILURE() << "validation layer: " << message;
  }
};

}  // namespace

int main(int argc, char** argv) {
  setenv("PALPATE_VALIDATION", "1", 1);
  testing::InitGoogleTest(&argc, argv);
  testing::UnitTest::GetInstance()->listeners().Append(new ValidationListener);
  return RUN_ALL_TESTS();
}
