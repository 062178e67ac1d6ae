// SPDX-License-Identifier: Apache-2.0
#include "base/error.hpp"

#include <set>

#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(Error, IsOneLineOfInputReasonAndRemedy) {
  const Error error(Error::Code::kIo, "scan.nrrd", "the disk is full", "free some space");
  EXPECT_STREQ(error.what(), "scan.nrrd: the disk is full; free some space");
  EXPECT_EQ(error.code(), Error::Code::kIo);
}

TEST(Error, EveryCodeHasItsOwnExitStatus) {
  using Code = Error::Code;
  std::set<int> seen = {0, 1};  // success, and a fault of ours
  for (const Code code :
       {Code::kBadInput, Code::kNotFound, Code::kIo, Code::kOutOfMemory, Code::kDevice, Code::kCancelled}) {
    EXPECT_TRUE(seen.insert(exitStatus(code)).second);
  }
}

}  // namespace
}  // namespace palpate
