// SPDX-License-Identifier: Apache-2.0
// With `cat`, which answers every line with itself, and programs that end or never were.
#include "apps/rivals/child_talk.hpp"

#include <gmock/gmock.h>
#include <sys/wait.h>

namespace palpate {
namespace child_talk_test {

TEST(ChildTalk, HearsLineByLine) {
  ChildTalk cat({"/bin/cat"});
  EXPECT_TRUE(cat.tell("one"));
  EXPECT_TRUE(cat.tell("two\tthree"));
  EXPECT_EQ(cat.hear(), "one");
  EXPECT_EQ(cat.hear(), "two\tthree");
  const std::string longer(100000, 'x');  // than a block
  EXPECT_TRUE(cat.tell(longer));
  EXPECT_EQ(cat.hear(), longer);
}

TEST(ChildTalk, KnowsThatItIsGone) {
  ChildTalk gone({"/bin/true"});
  EXPECT_EQ(gone.hear(), std::nullopt);
  EXPECT_FALSE(gone.tell("anybody there?"));
  ChildTalk never({"/nowhere/program"});
  EXPECT_EQ(never.hear(), std::nullopt);
}

TEST(ChildTalk, TellsHowItEnded) {
  ChildTalk three({"/bin/sh", "-c", "echo word; exit 3"});
  EXPECT_EQ(three.hear(), "word");
  EXPECT_EQ(three.hear(), std::nullopt);
  const int status = three.wait();
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 3);
  EXPECT_EQ(three.wait(), -1);
  EXPECT_EQ(ChildTalk({"/nowhere/program"}).wait(), -1);
}

}  // namespace child_talk_test
}  // namespace palpate
