// SPDX-License-Identifier: Apache-2.0
// apps/servo_side/servo_host.hpp: the other side of a RemoteServo: makes device, algorithm and loop as an engine's
// process says, and runs them. Links neither Vulkan nor OpenVDB.
//
// The servo's thread does what it does in one process (servo/loop); the caller's thread talks with the engine. One that
// does not stay brings the force to zero and ends its run when the engine is gone. One that stays keeps device and loop
// alive: the windows grow stale, the force fades by the loop's own rules, and the next engine of the same scene leads
// the running loop to its windows (servo/loop/servo_links.hpp). An engine of another scene gets a device and a loop
// that begin anew. No engine gets more than the servo's own ceilings allow. One thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "apps/servo_side/servo_ceilings.hpp"
#include "service/channel/channel.hpp"

namespace palpate {

// The first message of a servo that was built from `commit`. `first_version`: of the windows that this engine will show
// it. `stays`: it outlives its engine.
[[nodiscard]] std::vector<std::byte> greeting(const std::string& commit, std::uint64_t first_version, bool stays);

class ServoHost {
 public:
  using Tell = std::function<void(const std::string&)>;
  // `commit`: of this program, which must be the engine's. `tell`: what an engine asked for above the ceilings; and of
  // a servo that stays, what real time its loop lacks, that it begins, and that an engine sends no windows, or sends
  // them again; no result would say it.
  ServoHost(bool stays, std::string commit, Tell tell = {}, ServoCeilings ceilings = {});
  ~ServoHost();  // the force goes to zero; the device is let go

  // Of the windows that its next engine will show it.
  [[nodiscard]] std::uint64_t firstVersion() const;

  // Until the run that this engine asks for has ended, the engine says that it leaves, or `stopped` says so, which is
  // asked every some milliseconds. `is_greeted`: the greeting, with firstVersion(), was sent already. Throws Error:
  // kDevice if the engine is gone before; what its messages make impossible, which the engine is told too; and what
  // `stopped` throws.
  void serve(
      Channel channel, const std::function<bool()>& stopped = [] { return false; }, bool is_greeted = false);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate
