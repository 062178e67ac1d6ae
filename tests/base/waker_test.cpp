// SPDX-License-Identifier: Apache-2.0
#include "base/waker.hpp"

#include <chrono>
#include <thread>

#include <gmock/gmock.h>
#include <poll.h>

#include "few_descriptors.hpp"
#include "refusal.hpp"

namespace palpate {
namespace waker_test {

bool isAwake(const Waker& waker, int most_ms = 0) {
  pollfd wait = {.fd = waker.descriptor(), .events = POLLIN, .revents = 0};
  return poll(&wait, 1, most_ms) == 1;
}

TEST(Waker, SleepsUntilItIsWoken) {
  const Waker waker("the desk");
  EXPECT_FALSE(isAwake(waker));
  waker.wake();
  EXPECT_TRUE(isAwake(waker));
  EXPECT_TRUE(isAwake(waker));  // until somebody has looked
  waker.sleepAgain();
  EXPECT_FALSE(isAwake(waker));
}

TEST(Waker, IsWokenOnceHoweverOften) {
  const Waker waker("the desk");
  for (int n = 0; n < 1000; ++n) waker.wake();
  EXPECT_TRUE(isAwake(waker));
  waker.sleepAgain();
  EXPECT_FALSE(isAwake(waker));
  waker.sleepAgain();  // waits for nothing
}

TEST(Waker, EndsThePollOfAnotherThread) {
  const Waker waker("the desk");
  constexpr int kLong_ms = 60'000;
  bool was_woken = false;
  std::thread sleeper([&] { was_woken = isAwake(waker, kLong_ms); });
  std::this_thread::sleep_for(std::chrono::milliseconds(20));  // it polls, most probably
  waker.wake();
  sleeper.join();
  EXPECT_TRUE(was_woken);
}

TEST(Waker, RefusesWhereNoDescriptorIsLeft) {
  std::string refusal;
  {
    const FewDescriptors few;
    refusal = refusalOf([] { const Waker waker("the desk"); }, Error::Code::kIo);
  }
  EXPECT_THAT(refusal,
              testing::AllOf(testing::HasSubstr("the desk: nothing can wake it"), testing::HasSubstr("ulimit -n")));
}

}  // namespace waker_test
}  // namespace palpate
