// SPDX-License-Identifier: Apache-2.0
#include "base/thread_names.hpp"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>

#include <pthread.h>

namespace palpate {

void nameThisThread(const char* name) noexcept {
  static_cast<void>(pthread_setname_np(pthread_self(), name));
}

void nameThread(std::thread::native_handle_type thread, const char* name) noexcept {
  static_cast<void>(pthread_setname_np(thread, name));
}

std::vector<std::string> threadNames() {
  namespace fs = std::filesystem;
  std::vector<long> ids;
  std::error_code ignored;
  for (const fs::directory_entry& task : fs::directory_iterator("/proc/self/task", ignored)) {
    const std::string id = task.path().filename().string();
    long number = 0;
    if (std::from_chars(id.data(), id.data() + id.size(), number).ec == std::errc()) ids.push_back(number);
  }
  std::sort(ids.begin(), ids.end());
  std::vector<std::string> names;
  for (const long id : ids) {
    std::ifstream file("/proc/self/task/" + std::to_string(id) + "/comm");
    std::string name;
    if (std::getline(file, name)) names.push_back(std::move(name));  // else it has ended meanwhile
  }
  return names;
}

}  // namespace palpate
