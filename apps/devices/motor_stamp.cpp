// SPDX-License-Identifier: Apache-2.0
#include "apps/devices/motor_stamp.hpp"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>

#include <fmt/format.h>

#include "base/atomic_file.hpp"
#include "base/error.hpp"
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

}  // namespace

MotorStamp::MotorStamp(const CheckedAs& device)
    : file_(motorStampFile(device)),
      identity_(fmt::format("motors checked, 1\n{}\n{}\n{}\n", device.kind, device.usb, device.place)) {
  for (const auto& [key, value] : device.values) identity_ += fmt::format("{} = {}\n", key, value);
}

bool MotorStamp::isThere() const {
  if (file_.empty()) return false;
  std::ifstream stream(file_, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(stream), {}) == identity_;
}

void MotorStamp::remove() const {
  std::error_code ignored;
  if (!file_.empty()) std::filesystem::remove(file_, ignored);
}

bool MotorStamp::put() const {
  if (file_.empty()) return false;
  std::error_code ignored;
  std::filesystem::create_directories(file_.parent_path(), ignored);
  try {
    writeFileAtomically(file_, identity_);
  } catch (const Error&) {
    return false;
  }
  return true;
}

}  // namespace palpate
