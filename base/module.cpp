// SPDX-License-Identifier: Apache-2.0
#include "base/module.hpp"

#include <system_error>

#include <dlfcn.h>
#include <fmt/format.h>

#include "base/error.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr const char* kOneBuild = "take the program and the folder lib/palpate from one build";

bool loads_no_more = false;  // loadAhead() was called

// What is mended now comes into a servo's process no more.
Error notLoaded(const fs::path& file, const std::string& reason, const std::string& remedy) {
  return {Error::Code::kNotFound, file.string(), reason,
          loads_no_more ? remedy + ", and start the servo again" : remedy};
}

// The reason alone: dlerror() puts the file's name in front of it.
std::string loaderWords(const fs::path& file) {
  const char* words = dlerror();
  std::string text = words != nullptr ? words : "it gives no reason";
  const std::string prefix = file.string() + ": ";
  if (text.starts_with(prefix)) text.erase(0, prefix.size());
  return text;
}

}  // namespace

fs::path moduleFile(const std::string& name) {
  std::error_code unknown;
  const fs::path program = fs::read_symlink("/proc/self/exe", unknown);
  return program.parent_path().parent_path() / "lib" / "palpate" / (name + ".so");
}

const void* moduleTable(const fs::path& file, const std::string& table) {
  std::error_code unknown;
  if (!fs::exists(file, unknown)) {
    throw notLoaded(file, "this part of Palpate is missing",
                    "build it with ./dev build, or copy the folder lib/palpate along with the program's own");
  }
  // All symbols now: a servo thread that meets one for the first time must not enter the loader.
  void* library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    throw notLoaded(file, fmt::format("this part of Palpate cannot be loaded ({})", loaderWords(file)),
                    "install the library that is missing; packages.txt lists the packages");
  }
  const auto* version = static_cast<const char*>(dlsym(library, "palpate_module_version"));
  if (version == nullptr || std::string(version) != PALPATE_VERSION) {
    throw notLoaded(file,
                    fmt::format("it is a part of Palpate {}, and this is {}",
                                version != nullptr ? version : "of unknown version", PALPATE_VERSION),
                    kOneBuild);
  }
  const void* found = dlsym(library, table.c_str());
  if (found == nullptr) {
    throw notLoaded(file, fmt::format("it has no {}", table), kOneBuild);
  }
  return found;
}

void loadAhead(std::initializer_list<const char*> names) noexcept {
  loads_no_more = true;
  for (const char* name : names) static_cast<void>(dlopen(moduleFile(name).c_str(), RTLD_NOW | RTLD_LOCAL));
}

}  // namespace palpate
