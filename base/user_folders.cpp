// SPDX-License-Identifier: Apache-2.0
#include "base/user_folders.hpp"

#include <cstdlib>

namespace palpate {
namespace {

std::filesystem::path absolutePathIn(const char* variable) {
  const char* const value = std::getenv(variable);
  if (value == nullptr) return {};
  std::filesystem::path path(value);
  return path.is_absolute() ? path : std::filesystem::path();
}

std::filesystem::path folder(const char* variable, const char* below_home) {
  const std::filesystem::path own = absolutePathIn(variable);
  if (!own.empty()) return own / "palpate";
  const std::filesystem::path home = absolutePathIn("HOME");
  return home.empty() ? home : home / below_home / "palpate";
}

}  // namespace

std::filesystem::path settingsFolder() {
  return folder("XDG_CONFIG_HOME", ".config");
}
std::filesystem::path stateFolder() {
  return folder("XDG_STATE_HOME", ".local/state");
}
std::filesystem::path cacheFolder() {
  return folder("XDG_CACHE_HOME", ".cache");
}
std::filesystem::path runtimeFolder() {
  const std::filesystem::path runtime = absolutePathIn("XDG_RUNTIME_DIR");
  return runtime.empty() ? runtime : runtime / "palpate";
}

std::filesystem::path calibrationsFolder() {
  const std::filesystem::path runtime = runtimeFolder();
  return runtime.empty() ? runtime : runtime / "calibrated";
}

}  // namespace palpate
