// SPDX-License-Identifier: Apache-2.0
#include "apps/scene/flag_errors.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "servo/contact/effects.hpp"
#include "servo/safety/safety_gate.hpp"

namespace palpate {
namespace flag_errors_test {

// What the servo itself throws.
template <typename Work>
std::string refusal(Work work) {
  try {
    work();
  } catch (const Error& error) {
    return withFlag(error).what();
  }
  return "no error";
}

TEST(FlagErrors, NameTheFlagAndTheKey) {
  EXPECT_THAT(refusal([] { (void)SafetyGate({.force_limit_N = 0}, 1000); }),
              testing::StartsWith("--force-limit (key safety.force_limit_N): 0 cannot be used; "));
  EXPECT_THAT(
      refusal([] { (void)makeContactEffects({.friction = {.dynamic_ratio = 0.5}}, 500, 1000); }),
      testing::StartsWith("--friction-dynamic (key contact.friction_dynamic): 0.5 cannot be used; give at most"));
}

TEST(FlagErrors, LeaveOthersAsTheyAre) {
  const Error file(Error::Code::kIo, "rate", "cannot be read", "check it");  // a file of that name
  EXPECT_STREQ(withFlag(file).what(), file.what());
  const Error other(Error::Code::kBadInput, "scan.nrrd", "is cut short", "get it again");
  EXPECT_STREQ(withFlag(other).what(), other.what());
  EXPECT_EQ(withFlag(other).code(), other.code());
}

}  // namespace flag_errors_test
}  // namespace palpate
