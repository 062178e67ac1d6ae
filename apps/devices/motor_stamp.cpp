// SPDX-License-Identifier: Apache-2.0
#include "apps/devices/motor_stamp.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>

#include <fmt/format.h>

#include "base/user_folders.hpp"

namespace palpate {
namespace {

std::filesystem::path motorStampFile(const CheckedAs& device) {
  const std::filesystem::path folder = stateFolder();
  if (folder.empty()) return {};
  std::string name = fmt::format("{}_{}_{}", device.kind, device.usb, device.place);
  std::ranges::replace_if(
      name, [](unsigned char c) { return std::isalnum(c) == 0 && c != '-' && c != '_'; }, '_');
  return folder / "motors" / name;
}

std::string checkedWords(const CheckedAs& device) {
  std::string words = fmt::format("motors checked, 1\n{}\n{}\n{}\n", device.kind, device.usb, device.place);
  for (const auto& [key, value] : device.values) words += fmt::format("{} = {}\n", key, value);
  return words;
}

}  // namespace

MotorStamp::MotorStamp(const CheckedAs& device) : stamp_(motorStampFile(device), checkedWords(device)) {}

}  // namespace palpate
