// SPDX-License-Identifier: Apache-2.0
// service/sandbox/file_fence.hpp: from now on this process reads files, and writes to devices and in one folder alone.
//
// By Landlock, which the kernel has since 5.13 and which needs no rights. A filter of system calls cannot do it, since
// it does not see paths. Elsewhere nothing can be made, removed, renamed or emptied, and nowhere run. What is open
// already, sockets, anonymous memory, and the rights and times of files are not concerned. Newer kernels also keep
// signals to this process and the children that it has from now on (6.12), and refuse TCP (6.7). Thread: the only one,
// before it starts others. Some system calls. Linux only.
#pragma once

#include <string>

namespace palpate {

// The version of Landlock that the kernel has; 0: none. Changes nothing. Any thread.
[[nodiscard]] int landlockVersion() noexcept;

struct FileFence {
  bool stands = false;
  bool holds_signals = false;  // a signal reaches this process and its children, and nobody else
  std::string why_not;         // it does not stand
};

// Below `devices` what exists may be opened for writing, and takes ioctl(2). In `own` plain files may be made, written,
// renamed and removed. Both are folders that exist; empty: none. The process must not be able to gain rights
// (PR_SET_NO_NEW_PRIVS). Throws nothing.
[[nodiscard]] FileFence fenceFiles(const std::string& devices, const std::string& own);

}  // namespace palpate
