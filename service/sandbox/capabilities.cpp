// SPDX-License-Identifier: Apache-2.0
#include "service/sandbox/capabilities.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>

#include <linux/capability.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace palpate {
namespace {

using CapabilitySet = std::uint64_t;  // bit n: capability n

constexpr CapabilitySet only(int capability) {
  return CapabilitySet{1} << static_cast<unsigned>(capability);
}

CapabilitySet permittedCapabilities() {
  __user_cap_header_struct head = {.version = _LINUX_CAPABILITY_VERSION_3, .pid = 0};
  __user_cap_data_struct halves[2] = {};
  if (syscall(SYS_capget, &head, halves) != 0) return 0;
  return CapabilitySet{halves[1].permitted} << 32U | halves[0].permitted;
}

bool setCapabilities(CapabilitySet kept) {
  __user_cap_header_struct head = {.version = _LINUX_CAPABILITY_VERSION_3, .pid = 0};
  __user_cap_data_struct halves[2] = {};
  halves[0].permitted = halves[0].effective = static_cast<std::uint32_t>(kept);
  halves[1].permitted = halves[1].effective = static_cast<std::uint32_t>(kept >> 32U);
  return syscall(SYS_capset, &head, halves) == 0;
}

// True: from now on the limit alone gives `wanted`. RLIM_INFINITY is the largest number.
bool limitGives(int resource, rlim_t wanted, bool may_raise) {
  rlimit limit = {};
  if (getrlimit(static_cast<__rlimit_resource_t>(resource), &limit) != 0) return false;
  if (limit.rlim_cur >= wanted) return true;
  if (limit.rlim_max < wanted && !may_raise) return false;
  limit.rlim_max = std::max(limit.rlim_max, wanted);
  limit.rlim_cur = wanted;
  return setrlimit(static_cast<__rlimit_resource_t>(resource), &limit) == 0;
}

// What no limit replaces.
CapabilitySet stillNeeded(CapabilitySet permitted) {
  const bool may_raise = (permitted & only(CAP_SYS_RESOURCE)) != 0;
  CapabilitySet needed = 0;
  if ((permitted & only(CAP_SYS_NICE)) != 0 && !limitGives(RLIMIT_RTPRIO, kRealTimePriorityLimit, may_raise))
    needed |= only(CAP_SYS_NICE);
  if ((permitted & only(CAP_IPC_LOCK)) != 0 && !limitGives(RLIMIT_MEMLOCK, RLIM_INFINITY, may_raise))
    needed |= only(CAP_IPC_LOCK);
  return needed;
}

// Needs CAP_SETPCAP. Without it the set stays; it gives rights to programs that are run, and none may be.
void emptyBoundingSet() {
  for (unsigned long capability = 0; capability < 64; ++capability)
    if (prctl(PR_CAPBSET_READ, capability, 0, 0, 0) == 1) prctl(PR_CAPBSET_DROP, capability, 0, 0, 0);
}

}  // namespace

CapabilitiesLeft dropCapabilities(RealTime real_time) {
  CapabilitiesLeft left;
  const CapabilitySet needed = real_time == RealTime::kKept ? stillNeeded(permittedCapabilities()) : 0;
  emptyBoundingSet();
  prctl(PR_CAP_AMBIENT, PR_CAP_AMBIENT_CLEAR_ALL, 0, 0, 0);
  if (!setCapabilities(needed)) left.failure = std::strerror(errno);
  if ((needed & only(CAP_SYS_NICE)) != 0) left.kept.emplace_back("cap_sys_nice");
  if ((needed & only(CAP_IPC_LOCK)) != 0) left.kept.emplace_back("cap_ipc_lock");
  return left;
}

}  // namespace palpate
