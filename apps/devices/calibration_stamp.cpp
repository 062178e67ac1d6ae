// SPDX-License-Identifier: Apache-2.0
#include "apps/devices/calibration_stamp.hpp"

#include <algorithm>
#include <cstdint>
#include <filesystem>

#include <fmt/format.h>
#include <sys/stat.h>

#include "base/monotonic_clock.hpp"
#include "base/user_folders.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

fs::path stampFile(const std::string& device_path) {
  const fs::path folder = calibrationsFolder();
  if (folder.empty()) return {};
  std::string name = device_path;
  std::ranges::replace(name, '/', '_');
  return folder / ("device" + name);
}

// Of the machine's sleep [0.1 s]: a device may lose its power meanwhile, and keep its file.
std::int64_t sleepOfMachine() {
  constexpr std::int64_t kTenthOfASecond_ns = 100'000'000;
  return suspended_ns() / kTenthOfASecond_ns;
}

// Empty: there is no such file.
std::string identityOf(const CalibratedAs& device) {
  struct stat facts = {};
  if (stat(device.path.c_str(), &facts) != 0) return {};
  std::string identity = fmt::format("{} {} {}.{:09} {}\n{}\n", device.path, facts.st_ino, facts.st_ctim.tv_sec,
                                     facts.st_ctim.tv_nsec, sleepOfMachine(), device.kind);
  for (const auto& [key, value] : device.values) identity += fmt::format("{} = {}\n", key, value);
  return identity;
}

}  // namespace

CalibrationStamp::CalibrationStamp(const CalibratedAs& device) : stamp_(stampFile(device.path), identityOf(device)) {}

bool CalibrationStamp::take() {
  const bool was_there = isThere();
  stamp_.remove();
  return was_there;
}

}  // namespace palpate
