// SPDX-License-Identifier: Apache-2.0
#include "base/error.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "tests/support/refusal.hpp"

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

// Scripts rely on them.
TEST(Error, EveryCodeHasItsOwnExitStatus) {
  using Code = Error::Code;
  EXPECT_EQ(exitStatus(Code::kBadInput), 2);
  EXPECT_EQ(exitStatus(Code::kNotFound), 3);
  EXPECT_EQ(exitStatus(Code::kIo), 4);
  EXPECT_EQ(exitStatus(Code::kOutOfMemory), 5);
  EXPECT_EQ(exitStatus(Code::kDevice), 6);
  EXPECT_EQ(exitStatus(Code::kCancelled), 130);
}

TEST(Error, RefusalsSayWhatToDo) {
  EXPECT_EQ(refusalOf([] { refuse("a", "is b", "do c"); }), "a: is b; do c");
  EXPECT_EQ(refusalOf([] { refuseDamaged("a", "is b"); }),
            "a: is b; the file may be cut short or damaged: copy or write it again");
}

TEST(Error, ASettingMustBeGoodAndFinite) {
  EXPECT_EQ(refusalOf([] { checkSetting(true, "stiffness", 5, "give 0 or more"); }), kNoRefusal);
  EXPECT_EQ(refusalOf([] { checkSetting(false, "stiffness", -1.5, "give 0 or more"); }),
            "stiffness: -1.5 cannot be used; give 0 or more");
  EXPECT_EQ(refusalOf([] { checkSetting(true, "stiffness", std::numeric_limits<double>::infinity(), "give less"); }),
            "stiffness: inf cannot be used; give less");
}

}  // namespace error_test
}  // namespace palpate
