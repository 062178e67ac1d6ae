// SPDX-License-Identifier: Apache-2.0
// service/sandbox/servo_sandbox.hpp: a servo's process gives up the rights that it has no use for, before it hears the
// first word from outside.
//
// In this order: no rights by running other programs; no capabilities (capabilities.hpp); no memory image on a crash,
// and no other program of the same user looks into the process (PR_SET_DUMPABLE); files are read only, but for USB
// devices and a folder of the servo's own, and the rest of /dev not even that (file_fence.hpp); system calls by a list
// (call_filter.hpp). Children and threads inherit all of it, and nothing gives it back. It happens at the start, and
// not once the device is open: a servo that stays opens devices and takes its real-time priority again and again, and
// so nothing that an engine or a device says is read with more rights. What the servo must have from outside
// afterwards, the connection to an engine and a HID device, another process hands to it (service/broker). The libraries
// that it may ever need are loaded before: afterwards no machine code comes into the process.
//
// Where a system lacks one of these the others stand, and the servo goes on: it says what is missing. The user is not
// changed: a servo that root starts stays root, without capabilities, and reads what root may read.
// Thread: the only one. Some milliseconds. Throws nothing. Linux only.
#pragma once

#include <string>
#include <vector>

#include "service/sandbox/file_fence.hpp"

namespace palpate {

struct SandboxReport {
  std::vector<std::string> given_up;  // "capabilities"
  std::vector<std::string> missing;   // what the system does not let it give up, why, and what to do about it
  std::vector<std::string> kept;      // what it has use for: capabilities that no limit replaces
  bool is_root = false;               // user 0, whom a servo has no use for
};

// `own_folder`: in it plain files may still be made and removed; it exists. Empty: none.
[[nodiscard]] SandboxReport enterServoSandbox(const std::string& own_folder = "");

// Of files and system calls: what is not given up, and in brackets why, and what to do where something can be done.
// `no_filter`: as filterCalls() says it.
[[nodiscard]] std::vector<std::string> missingOf(const FileFence& fence, const std::string& no_filter);

// One line.
[[nodiscard]] std::string wordsOf(const SandboxReport& report);

}  // namespace palpate
