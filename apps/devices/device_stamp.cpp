// SPDX-License-Identifier: Apache-2.0
#include "apps/devices/device_stamp.hpp"

#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

#include "base/atomic_file.hpp"
#include "base/error.hpp"

namespace palpate {

DeviceStamp::DeviceStamp(std::filesystem::path file, std::string words)
    : file_(std::move(file)), words_(std::move(words)) {}

bool DeviceStamp::isThere() const {
  if (file_.empty() || words_.empty()) return false;
  std::ifstream stream(file_, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(stream), {}) == words_;
}

void DeviceStamp::remove() const {
  std::error_code ignored;
  if (!file_.empty()) std::filesystem::remove(file_, ignored);
}

bool DeviceStamp::put() const {
  if (file_.empty() || words_.empty()) return false;
  std::error_code ignored;
  std::filesystem::create_directories(file_.parent_path(), ignored);
  try {
    writeFileAtomically(file_, words_);
  } catch (const Error&) {
    return false;
  }
  return true;
}

}  // namespace palpate
