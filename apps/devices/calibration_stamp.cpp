// SPDX-License-Identifier: Apache-2.0
#include "apps/devices/calibration_stamp.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <fmt/format.h>
#include <sys/stat.h>

#include "base/atomic_file.hpp"
#include "base/error.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

fs::path stampFile(const std::string& device_path) {
  const char* runtime = std::getenv("XDG_RUNTIME_DIR");
  if (runtime == nullptr || *runtime != '/') return {};
  std::string name = device_path;
  std::ranges::replace(name, '/', '_');
  return fs::path(runtime) / "palpate" / ("calibrated" + name);
}

// Empty: there is no such file.
std::string identityOf(const std::string& device_path) {
  struct stat facts = {};
  if (stat(device_path.c_str(), &facts) != 0) return {};
  return fmt::format("{} {} {}.{:09}\n", device_path, facts.st_ino, facts.st_ctim.tv_sec, facts.st_ctim.tv_nsec);
}

}  // namespace

bool isStampedCalibrated(const std::string& device_path) {
  const std::string identity = identityOf(device_path);
  const fs::path file = stampFile(device_path);
  if (identity.empty() || file.empty()) return false;
  std::ifstream stream(file, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(stream), {}) == identity;
}

bool stampCalibrated(const std::string& device_path) {
  const std::string identity = identityOf(device_path);
  const fs::path file = stampFile(device_path);
  if (identity.empty() || file.empty()) return false;
  std::error_code ignored;
  fs::create_directories(file.parent_path(), ignored);
  try {
    writeFileAtomically(file, identity);
  } catch (const Error&) {
    return false;
  }
  return true;
}

}  // namespace palpate
