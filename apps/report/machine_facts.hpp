// SPDX-License-Identifier: Apache-2.0
// apps/report/machine_facts.hpp: the machine on which figures were measured.
#pragma once

#include <cstdint>
#include <string>

namespace palpate {

struct MachineFacts {
  std::string cpu;                 // model name
  int cores = 0;                   // that this process may use [-]
  std::uint64_t memory_bytes = 0;  // main memory of the machine [byte]
  std::string kernel;              // "Linux 6.1.0-18-amd64"
  std::string os;                  // "Debian GNU/Linux 12 (bookworm)"
};

// Reads /proc and /etc/os-release. What cannot be read is "unknown" or 0; never throws for that. Any thread; reads
// files.
[[nodiscard]] MachineFacts readMachineFacts();

}  // namespace palpate
