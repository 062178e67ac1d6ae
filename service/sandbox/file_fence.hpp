// SPDX-License-Identifier: Apache-2.0
// service/sandbox/file_fence.hpp: from now on this process reads files, and writes to some devices and in one folder.
//
// By Landlock, which the kernel has since 5.13 and which needs no rights. A filter of system calls cannot do it, since
// it does not see paths. Elsewhere nothing can be made, removed, renamed or emptied, and nowhere run. In the folder of
// all devices nothing else can even be read: other programs' shared memory lies there, too, and what a keyboard or a
// camera says. What is open already, sockets at paths, anonymous memory, and the rights and times of files are not
// concerned. Newer kernels also keep signals and connections to abstract sockets to this process and the children that
// it has from now on (6.12), and refuse TCP (6.7).
// Thread: the only one, before it starts others. Some system calls. Linux only.
#pragma once

#include <string>
#include <vector>

namespace palpate {

// The version of Landlock that the kernel has; 0: none. Changes nothing. Any thread.
[[nodiscard]] int landlockVersion() noexcept;

struct FileFence {
  bool stands = false;
  bool holds_signals = false;   // a signal reaches this process and its children, and nobody else
  bool holds_emptying = false;  // no file is emptied but in the folder of its own; an older kernel lets that through
  std::string why_not = {};     // it does not stand; and what to do, where something can be done
};

struct FencedPlaces {
  // A folder. All that lies beside it, at this moment, can be read, but nothing in it, by whatever name. (A kernel's
  // rule holds for a whole tree. So the tree itself, "/" for "/dev", cannot be listed any more; what is mounted there
  // later cannot be read; and what lies beside it and leads into it, or to all that it lies in, cannot either.)
  std::string hidden;
  // Files, or folders for what is or will be in them, which may be read and written, and take ioctl(2).
  std::vector<std::string> devices = {};
  // A folder in which plain files may be made, written, renamed and removed. Empty: none.
  std::string own = {};
};

// All of these must exist. The process must not be able to gain rights (PR_SET_NO_NEW_PRIVS). Throws nothing.
[[nodiscard]] FileFence fenceFiles(const FencedPlaces& places);

}  // namespace palpate
