// SPDX-License-Identifier: Apache-2.0
// apps/devices/device_stamp.hpp: a small file that remembers something of a device from one program to the next.
//
// The file holds words that say of what device, and as what, it was so. It counts only where these words are the same
// to the letter. Any thread. Throws nothing but for memory: a stamp that cannot be kept is none.
#pragma once

#include <filesystem>
#include <string>

namespace palpate {

class DeviceStamp {
 public:
  // `file` empty: none can be kept. `words` empty: there is no device of which something could be remembered.
  DeviceStamp(std::filesystem::path file, std::string words);
  [[nodiscard]] bool isThere() const;
  // Also one with other words.
  void remove() const;
  // Makes the folder, too. False: it could not be kept.
  bool put() const;
  [[nodiscard]] const std::filesystem::path& file() const noexcept { return file_; }

 private:
  std::filesystem::path file_;
  std::string words_;
};

}  // namespace palpate
