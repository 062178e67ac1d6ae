// SPDX-License-Identifier: Apache-2.0
// service/sandbox/capabilities.hpp: the root's rights that a process was started with, given up for good.
//
// Two of them a servo has use for: CAP_SYS_NICE for its real-time priority and CAP_IPC_LOCK for memory that is never
// swapped out. Limits can say the same (rtprio, memlock), and last when the capabilities are gone. So where the process
// may raise its limits (CAP_SYS_RESOURCE) it turns the two into limits first. Where it may not, and the limits do not
// give what the capability gave, it keeps the capability: a servo that stays takes its priority anew with each loop.
// Thread: capabilities are a thread's own, so the only one, before it starts others. Some system calls. Linux only.
#pragma once

#include <string>
#include <vector>

namespace palpate {

inline constexpr int kRealTimePriorityLimit = 95;  // as `palpate doctor` and the units ask for it (rtprio)

struct CapabilitiesLeft {
  std::vector<std::string> kept;  // "cap_sys_nice", since no limit replaces them
  std::string failure;            // why they could not be given up; empty: they were
};

enum class RealTime { kKept, kGivenUp };

// Gives up all capabilities but the two above where they must be kept: permitted, effective, inheritable, ambient, and
// the bounding set where it may. kGivenUp: those two as well, for a process that has no use for real time; its limits
// stay as they are. Throws nothing.
[[nodiscard]] CapabilitiesLeft dropCapabilities(RealTime real_time = RealTime::kKept);

}  // namespace palpate
