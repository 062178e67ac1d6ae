// SPDX-License-Identifier: Apache-2.0
#include "process_facts.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include <fmt/format.h>

namespace palpate {
namespace {

std::size_t entriesIn(const std::string& folder) {
  std::error_code gone;
  const std::filesystem::directory_iterator entries(folder, gone);
  return gone ? 0 : static_cast<std::size_t>(std::distance(begin(entries), end(entries)));
}

}  // namespace

double ownMemory(pid_t process) {
  std::ifstream file(fmt::format("/proc/{}/status", process));
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string key;
    double kib = 0;
    if (words >> key >> kib && key == "RssAnon:") return 1024 * kib;
  }
  return 0;
}

std::size_t openDescriptorsOf(pid_t process) {
  return entriesIn(fmt::format("/proc/{}/fd", process));
}

std::size_t threadsOf(pid_t process) {
  return entriesIn(fmt::format("/proc/{}/task", process));
}

pid_t childOf(pid_t process, const std::string& name) {
  std::error_code gone;
  for (const auto& task : std::filesystem::directory_iterator(fmt::format("/proc/{}/task", process), gone)) {
    std::ifstream children(task.path() / "children");
    for (pid_t child = 0; children >> child;) {
      std::ifstream file(fmt::format("/proc/{}/comm", child));
      std::string comm;
      if (std::getline(file, comm) && comm == name) return child;
    }
  }
  return 0;
}

}  // namespace palpate
