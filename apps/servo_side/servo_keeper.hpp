// SPDX-License-Identifier: Apache-2.0
// apps/servo_side/servo_keeper.hpp: a servo for the engines that listen at a socket, one after another.
//
// It looks for an engine every tenth of a second, and keeps device and loop alive while there is none (servo_host.hpp).
// One thread. Blocks until `stopped`, which is asked every some milliseconds.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "apps/servo_side/servo_ceilings.hpp"
#include "service/channel/channel.hpp"

namespace palpate {

struct ServoKeeping {
  std::string socket;  // that engines listen at, for words
  std::string commit;  // of this program
  // A connection to the engine there on which the greeting of a servo that stays was sent (servo_host.hpp). An Error is
  // told, and it is tried again; anything else that it throws ends the servo.
  std::function<Channel(std::uint64_t first_version)> reach;
  ServoCeilings ceilings = {};
  std::function<bool()> stopped;  // what it throws ends the servo, too
  // That an engine came, went, was refused, or asked for more than the ceilings allow, the same words once; that one
  // sends no windows, or does again (stale_watch.hpp); and what real time a loop lacks, once for each loop.
  std::function<void(const std::string&)> tell;
};

// Connects to the engine at `socket` and greets it. Throws Error as connectTo(), and kDevice if it is gone again.
[[nodiscard]] Channel reachEngine(const std::string& socket, const std::string& commit, std::uint64_t first_version);

// Throws nothing but what ServoHost's end, `reach` and `stopped` throw: an engine that is not there, not this user's,
// or asks for what cannot be is told, and looked for again.
void keepServo(const ServoKeeping& keeping);

}  // namespace palpate
