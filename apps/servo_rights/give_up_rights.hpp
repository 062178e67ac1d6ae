// SPDX-License-Identifier: Apache-2.0
// apps/servo_rights/give_up_rights.hpp: a servo's process gives up its rights, in the one order in which that works.
//
// 1. The table of devices is read, so that broker and servo know the same kinds.
// 2. The broker is started (service/broker), with rights that this process gives up, and from it on nodes of hidraw
// come.
// 3. The libraries are loaded that may ever be needed.
// 4. The sandbox is entered (service/sandbox); what is missing is in its report.
// Thread: the only one, before it starts others; once. Some milliseconds. Linux only.
#pragma once

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <memory>
#include <string>

#include "service/broker/broker.hpp"
#include "service/channel/channel.hpp"
#include "service/sandbox/servo_sandbox.hpp"

namespace palpate {

struct RightsNeeded {
  // As Broker::Tasks::greet; empty: it connects to nobody.
  std::function<Channel(std::uint64_t first_version)> greet = {};
  std::initializer_list<const char*> modules = {};  // that a scene may need, of the rooms that the program links
  std::string own_folder = {};                      // as enterServoSandbox()
};

struct WithoutRights {
  std::unique_ptr<Broker> broker;  // outlives all use of HID devices
  SandboxReport report;
};

// Throws Error(kOutOfMemory) if no process can be started for the broker now.
[[nodiscard]] WithoutRights giveUpRights(const RightsNeeded& needed);

}  // namespace palpate
