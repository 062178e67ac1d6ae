// SPDX-License-Identifier: Apache-2.0
// service/sandbox/sandbox.hpp: what the servo's process gives up before it talks with anybody: rights that it does not
// need, for ever, in all its threads and children.
//
// - Rights come back by no program that it could start (no_new_privs), and it may start none.
// - Of the capabilities that a unit or root gave it, only those for real-time priority and locked memory stay: each
//   loop asks for these anew.
// - A filter of system calls (seccomp): what a servo uses is allowed; what only an attacker would use (starting
//   programs, tracing others, mounting, loading code into the kernel) kills the process; all else fails with EPERM.
//   Sockets are Unix sockets, and those by which the kernel tells of devices. A servo that is killed is a hand without
//   force: the device's watchdog cuts it (docs/devices.md).
// - Files cannot be written, made or removed (Landlock), but devices below /dev can be written, and all of it is
//   allowed below the folders that the caller names. Files that are open already can be written.
// PALPATE_SANDBOX=off in the environment leaves all of it out, for debuggers.
//
// Set-up code: call it once, before other threads are made. Linux only. Throws nothing: what a kernel does not know is
// left out, and said.
#pragma once

#include <filesystem>
#include <span>
#include <string>

namespace palpate {

struct Sandbox {
  bool filters_calls = false;  // seccomp
  bool limits_files = false;   // Landlock
  std::string words;           // for the user: what was given up, and what was not, and why
};

// `kept`: folders below which files may be made, written and removed, as far as they are there.
[[nodiscard]] Sandbox enterSandbox(std::span<const std::filesystem::path> kept) noexcept;

}  // namespace palpate
