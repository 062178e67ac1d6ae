// SPDX-License-Identifier: Apache-2.0
#include "base/mapped_libraries.hpp"

#include <filesystem>
#include <string_view>

#include <link.h>

namespace palpate {

std::vector<std::string> mappedLibraries() {
  std::vector<std::string> names;
  const auto note = [](dl_phdr_info* library, std::size_t, void* to) {
    const std::string_view path = library->dlpi_name;  // the program itself has none; the kernel's vdso is no file
    if (path.find('/') != path.npos)
      static_cast<std::vector<std::string>*>(to)->push_back(std::filesystem::path(path).filename());
    return 0;
  };
  dl_iterate_phdr(note, &names);
  return names;
}

}  // namespace palpate
