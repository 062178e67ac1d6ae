// SPDX-License-Identifier: Apache-2.0
#include "apps/report/machine_facts.hpp"

#include <fstream>
#include <string_view>

#include <sched.h>
#include <sys/utsname.h>
#include <unistd.h>

namespace palpate {
namespace {

// The text after `key` and the separator, in the first line of `file` that begins with the key.
std::string valueOf(const char* file, std::string_view key, char separator) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with(key)) continue;
    std::string value = line.substr(std::min(line.find(separator), line.size() - 1) + 1);
    std::erase(value, '"');
    return value.substr(std::min(value.find_first_not_of(" \t"), value.size()));
  }
  return "unknown";
}

int allowedCores() {
  cpu_set_t set;
  return sched_getaffinity(0, sizeof(set), &set) == 0 ? CPU_COUNT(&set) : 0;
}

std::string kernelName() {
  utsname name{};
  return uname(&name) == 0 ? std::string(name.sysname) + " " + name.release : "unknown";
}

}  // namespace

MachineFacts readMachineFacts() {
  const long pages = sysconf(_SC_PHYS_PAGES), page_bytes = sysconf(_SC_PAGE_SIZE);
  return {.cpu = valueOf("/proc/cpuinfo", "model name", ':'),
          .cores = allowedCores(),
          .memory_bytes = pages > 0 && page_bytes > 0
                              ? static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(page_bytes)
                              : 0,
          .kernel = kernelName(),
          .os = valueOf("/etc/os-release", "PRETTY_NAME", '=')};
}

}  // namespace palpate
