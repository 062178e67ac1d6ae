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
std::string identityOf(const CalibratedAs& device) {
  struct stat facts = {};
  if (stat(device.path.c_str(), &facts) != 0) return {};
  std::string identity = fmt::format("{} {} {}.{:09}\n{}\n", device.path, facts.st_ino, facts.st_ctim.tv_sec,
                                     facts.st_ctim.tv_nsec, device.kind);
  for (const auto& [key, value] : device.values) identity += fmt::format("{} = {}\n", key, value);
  return identity;
}

}  // namespace

bool isStampedCalibrated(const CalibratedAs& device) {
  const std::string identity = identityOf(device);
  const fs::path file = stampFile(device.path);
  if (identity.empty() || file.empty()) return false;
  std::ifstream stream(file, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(stream), {}) == identity;
}

bool stampCalibrated(const CalibratedAs& device) {
  const std::string identity = identityOf(device);
  const fs::path file = stampFile(device.path);
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

void forgetCalibration(const std::string& path) noexcept {
  std::error_code ignored;
  fs::remove(stampFile(path), ignored);
}

}  // namespace palpate
