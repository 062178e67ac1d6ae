// SPDX-License-Identifier: Apache-2.0
#include "start_window.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "base/error.hpp"

namespace palpate {

void startWindow() {
  std::ifstream stream("/proc/self/cmdline", std::ios::binary);
  std::string words{std::istreambuf_iterator<char>(stream), {}};
  std::vector<char*> list;
  for (std::size_t at = 0; at < words.size(); at += std::strlen(&words[at]) + 1) list.push_back(&words[at]);
  list.push_back(nullptr);
  std::error_code unknown;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", unknown);
  const std::filesystem::path program = self.parent_path() / "palpate-sculpt";
  execv(program.c_str(), list.data());
  throw Error(Error::Code::kNotFound, program.string(),
              fmt::format("the program with the window cannot be started ({})", std::strerror(errno)),
              "build it with ./dev build; 'palpate touch' and 'palpate render' need no window");
}

}  // namespace palpate
