// SPDX-License-Identifier: Apache-2.0
#include "base/error.hpp"

#include <set>

#include <gtest/gtest.h>

namespace palpate {
namespace error_test {

TEST(Error, IsOneLineOfInputReasonAndRemedy) {
  const Error error(Error::Code::kIo, "scan.nrrd", "the disk is full", "free some space");
  EXPECT_STREQ(error.what(), "scan.nrrd: the disk is full; free some space");
  EXPECT_EQ(error.code(), Error::Code::kIo);
}

// A file may be called so, and a key may hold it.
TEST(Error, StaysOneLineWhateverItsInputIsCalled) {
  const Error error(Error::Code::kIo, "scan\n.nrrd", "the key \"a\tb\r\" is \x1b[2J\x7f", "mend\vit");
  EXPECT_STREQ(error.what(), "scan?.nrrd: the key \"a?b?\" is ?[2J?; mend?it");
  EXPECT_EQ(error.input(), "scan?.nrrd");
  EXPECT_EQ(error.reason(), "the key \"a?b?\" is ?[2J?");
  EXPECT_EQ(error.remedy(), "mend?it");
}

TEST(Error, EveryCodeHasItsOwnExitStatus) {
  using Code = Error::Code;
  std::set<int> seen = {0, 1};  // success, and a fault of ours
  for (const Code code :
       {Code::kBadInput, Code::kNotFound, Code::kIo, Code::kOutOfMemory, Code::kDevice, Code::kCancelled}) {
    EXPECT_TRUE(seen.insert(exitStatus(code)).second);
  }
}

}  // namespace error_test
}  // namespace palpate
