// SPDX-License-Identifier: Apache-2.0
#include "base/thread_names.hpp"

#include <latch>
#include <thread>

#include <gmock/gmock.h>

namespace palpate {
namespace thread_names_test {

using testing::Contains;
using testing::Not;

TEST(ThreadNames, AreThoseOfTheThreadsThatLive) {
  std::latch named(1);
  std::latch seen(1);
  std::thread other([&] {
    nameThisThread("a test's thread");  // 15 characters, the longest
    named.count_down();
    seen.wait();
  });
  named.wait();
  const std::vector<std::string> with = threadNames();
  seen.count_down();
  other.join();
  EXPECT_THAT(with, Contains("a test's thread").Times(1));
  const std::vector<std::string> without = threadNames();
  EXPECT_EQ(without.size(), with.size() - 1);
  EXPECT_THAT(without, Not(Contains("a test's thread")));
}

// It may not have run yet.
TEST(ThreadNames, AreThereAsSoonAsTheMakerGivesThem) {
  std::latch seen(1);
  std::thread other([&] { seen.wait(); });
  nameThread(other.native_handle(), "made");
  const std::vector<std::string> names = threadNames();
  seen.count_down();
  other.join();
  EXPECT_THAT(names, Contains("made").Times(1));
}

TEST(ThreadNames, ANameThatIsTooLongIsLeftOut) {
  std::thread([] {
    nameThisThread("before");
    nameThisThread("sixteen letters!");
    EXPECT_THAT(threadNames(), Contains("before"));
  }).join();
}

}  // namespace thread_names_test
}  // namespace palpate
