// SPDX-License-Identifier: Apache-2.0
// service/sandbox/call_filter.hpp: a filter of system calls (seccomp) for a servo, in all threads, for good.
//
// What becomes of a call:
// - a servo has use for it: it is made;
// - nobody makes it by mistake (running a program, ptrace, mount, ...): the process is killed, and the device's
//   watchdog takes the force away. Who makes such a call does not run the servo's code any more;
// - it is newer than this list: "not implemented", upon which libraries take an older one;
// - any other: it fails with EPERM, and the servo lives. An update of a library that makes a call more must not drop
//   the force of a hand in contact. The kernel writes the call's number into its log (type=1326).
// Of some calls only some arguments are allowed. No file is emptied when it is opened, and none is locked: a lock on
// the folder of a socket or on a journal would keep an engine from ever starting again. No memory becomes executable:
// what a servo runs is loaded before. Signals go to the process itself, priorities and limits are the caller's own, and
// no lock lends a priority to others. Sockets are for whole packets or tell of devices, and none is connected to
// anybody: another process does that (service/broker). Threads share all that the process has, and ioctl(2) is for HID
// and USB devices. A build with a sanitizer may do more: its leak check looks into threads with ptrace. Linux, x86-64
// and aarch64.
// Thread: any; some milliseconds. Afterwards the calls that are always allowed cost nothing measurable: the kernel
// keeps them in a bit map (since 5.11).
#pragma once

#include <string>

namespace palpate {

// Whether the kernel has such filters. Changes nothing.
[[nodiscard]] bool hasCallFilters() noexcept;

// `signals_held`: the kernel lets signals to nobody else (file_fence.hpp), so kill(2) need not be refused. Why there is
// no filter; empty: there is. The process must not be able to gain rights (PR_SET_NO_NEW_PRIVS). Throws nothing.
[[nodiscard]] std::string filterCalls(bool signals_held);

}  // namespace palpate
