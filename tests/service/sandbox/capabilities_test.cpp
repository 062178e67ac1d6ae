// SPDX-License-Identifier: Apache-2.0
// Capabilities are gone for good, and with them nothing that a servo has use for. Truth: capget(2) and the limits
// themselves. What can be tried depends on who runs the tests; a root without CAP_SYS_RESOURCE is one in a container.
#include "service/sandbox/capabilities.hpp"

#include <gmock/gmock.h>
#include <linux/capability.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>

#include "in_child.hpp"

namespace palpate {
namespace capabilities_test {

struct Sets {
  std::uint64_t effective = 0, permitted = 0, inheritable = 0;
};

__user_cap_header_struct ownHead() {
  return {.version = _LINUX_CAPABILITY_VERSION_3, .pid = 0};
}

Sets present() {
  __user_cap_header_struct head = ownHead();
  __user_cap_data_struct halves[2] = {};
  syscall(SYS_capget, &head, halves);
  const auto joined = [](std::uint32_t high, std::uint32_t low) { return std::uint64_t{high} << 32U | low; };
  return {joined(halves[1].effective, halves[0].effective), joined(halves[1].permitted, halves[0].permitted),
          joined(halves[1].inheritable, halves[0].inheritable)};
}

bool has(int capability) {
  return (present().permitted >> static_cast<unsigned>(capability) & 1U) != 0;
}

// Of the first 32, takes all away but those.
void keepOnly(std::uint32_t capabilities) {
  __user_cap_header_struct head = ownHead();
  __user_cap_data_struct halves[2] = {};
  halves[0].permitted = halves[0].effective = capabilities;
  syscall(SYS_capset, &head, halves);
}

constexpr std::uint32_t kNice = 1U << CAP_SYS_NICE, kLock = 1U << CAP_IPC_LOCK;

void limit(__rlimit_resource_t resource, rlim_t most) {
  const rlimit none = {most, most};
  setrlimit(resource, &none);
}

class Capabilities : public testing::Test {
 protected:
  void SetUp() override {
    if (!has(CAP_SYS_NICE) || !has(CAP_IPC_LOCK))
      GTEST_SKIP() << "whoever runs the tests has no capabilities to give up";
  }
};

TEST_F(Capabilities, WithLimitsNoneIsLeft) {
  if (!has(CAP_SYS_RESOURCE)) GTEST_SKIP() << "whoever runs the tests may not raise limits";
  EXPECT_EQ(resultInChild([] {
              limit(RLIMIT_RTPRIO, 0);
              limit(RLIMIT_MEMLOCK, 65536);
              const CapabilitiesLeft left = dropCapabilities();
              const Sets now = present();
              if (!left.kept.empty() || !left.failure.empty()) return 1;
              if ((now.effective | now.permitted | now.inheritable) != 0) return 2;
              rlimit priority = {}, memory = {};
              getrlimit(RLIMIT_RTPRIO, &priority);
              getrlimit(RLIMIT_MEMLOCK, &memory);
              return priority.rlim_cur >= 95 && memory.rlim_cur == RLIM_INFINITY ? 0 : 3;
            }),
            0);
}

TEST_F(Capabilities, WhatNoLimitReplacesIsKeptAndNamed) {
  EXPECT_EQ(resultInChild([] {
              limit(RLIMIT_RTPRIO, 94);
              limit(RLIMIT_MEMLOCK, 65536);
              keepOnly(kNice | kLock | 1U << CAP_KILL);
              if (dropCapabilities().kept != std::vector<std::string>{"cap_sys_nice", "cap_ipc_lock"}) return 1;
              const Sets now = present();
              return now.permitted == (kNice | kLock) && now.effective == now.permitted && now.inheritable == 0 ? 0 : 2;
            }),
            0);
}

// By a process that has no use for real time.
TEST_F(Capabilities, NoneIsKeptWhereNoneIsNeeded) {
  EXPECT_EQ(resultInChild([] {
              limit(RLIMIT_RTPRIO, 94);
              keepOnly(kNice | kLock | 1U << CAP_KILL);
              rlimit before = {}, after = {};
              getrlimit(RLIMIT_RTPRIO, &before);
              const CapabilitiesLeft left = dropCapabilities(RealTime::kGivenUp);
              getrlimit(RLIMIT_RTPRIO, &after);
              const Sets now = present();
              if (!left.kept.empty() || !left.failure.empty() || after.rlim_max != before.rlim_max) return 1;
              return (now.effective | now.permitted | now.inheritable) == 0 ? 0 : 2;
            }),
            0);
}

// Not raised, since it was never allowed: limits are exchanged for capabilities, not added.
TEST_F(Capabilities, ALimitIsRaisedForACapabilityAlone) {
  if (!has(CAP_SYS_RESOURCE)) GTEST_SKIP() << "whoever runs the tests may not raise limits";
  EXPECT_EQ(resultInChild([] {
              limit(RLIMIT_RTPRIO, 0);
              keepOnly(kLock | 1U << CAP_SYS_RESOURCE);
              const CapabilitiesLeft left = dropCapabilities();
              rlimit priority = {};
              getrlimit(RLIMIT_RTPRIO, &priority);
              return left.kept.empty() && priority.rlim_max == 0 ? 0 : 1;
            }),
            0);
}

TEST_F(Capabilities, NoneIsInTheBoundingSet) {
  if (!has(CAP_SETPCAP)) GTEST_SKIP() << "whoever runs the tests may not change it";
  EXPECT_EQ(resultInChild([] {
              static_cast<void>(dropCapabilities());
              int left = 0;
              for (unsigned long n = 0; n < 64; ++n) left += prctl(PR_CAPBSET_READ, n, 0, 0, 0) == 1 ? 1 : 0;
              return left;
            }),
            0);
}

TEST(NoCapabilities, NothingToGiveUpIsNoFailure) {
  EXPECT_EQ(resultInChild([] {
              keepOnly(0);
              const CapabilitiesLeft left = dropCapabilities();
              return left.kept.empty() && left.failure.empty() ? 0 : 1;
            }),
            0);
}

}  // namespace capabilities_test
}  // namespace palpate
