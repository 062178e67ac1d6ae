// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/chores.hpp"

#include <atomic>
#include <vector>

#include <gtest/gtest.h>

namespace palpate {
namespace chores_test {

TEST(Chores, AreDoneInOrderByAnotherThread) {
  std::vector<int> done;
  std::thread::id worker;
  Chores chores("chores test");
  EXPECT_TRUE(chores.idle());
  for (int i = 0; i < 100; ++i) {
    chores.add([&, i] {
      worker = std::this_thread::get_id();
      done.push_back(i);
    });
  }
  chores.finish();
  EXPECT_TRUE(chores.idle());
  ASSERT_EQ(done.size(), 100U);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(done[static_cast<std::size_t>(i)], i);
  EXPECT_NE(worker, std::this_thread::get_id());
}

TEST(Chores, AreNotIdleWhileOneIsUnderWay) {
  std::atomic<bool> begun{false}, may_end{false};
  Chores chores("chores test");
  chores.add([&] {
    begun = true;
    begun.notify_all();
    may_end.wait(false);
  });
  begun.wait(false);
  EXPECT_FALSE(chores.idle());
  EXPECT_EQ(chores.waiting(), 0U);
  chores.add([] {});
  EXPECT_EQ(chores.waiting(), 1U);
  may_end = true;
  may_end.notify_all();
  chores.finish();
  EXPECT_TRUE(chores.idle());
}

TEST(Chores, ThatAreLeftAreDoneAtTheEnd) {
  int done = 0;
  {
    Chores chores("chores test");
    for (int i = 0; i < 10; ++i) chores.add([&] { ++done; });
  }
  EXPECT_EQ(done, 10);
}

}  // namespace chores_test
}  // namespace palpate
