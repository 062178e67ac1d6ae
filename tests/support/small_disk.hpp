// SPDX-License-Identifier: Apache-2.0
// A file system of 256 KiB in memory, which can be full. Only root may mount one, with CAP_SYS_ADMIN.
#pragma once

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include <sys/mount.h>
#include <sys/statvfs.h>

namespace palpate {

class SmallDisk {
 public:
  explicit SmallDisk(std::filesystem::path place) : place_(std::move(place)) {
    std::filesystem::create_directories(place_);
    mounted_ = mount("tmpfs", place_.c_str(), "tmpfs", 0, "size=256k") == 0;
  }
  ~SmallDisk() {
    if (mounted_) umount2(place_.c_str(), MNT_DETACH);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  [[nodiscard]] explicit operator bool() const { return mounted_; }
  [[nodiscard]] static std::string whyNot() {
    return std::string("no file system can be mounted here (") + std::strerror(errno) +
           "): only root may, with CAP_SYS_ADMIN";
  }

  // So that so much is left.
  void fill(std::size_t left_bytes = 0) const {
    makeRoom();
    struct statvfs room {};
    statvfs(place_.c_str(), &room);
    std::ofstream(place_ / "filler") << std::string(room.f_bavail * room.f_bsize - left_bytes, 'x');
  }
  void makeRoom() const { std::filesystem::remove(place_ / "filler"); }

 private:
  std::filesystem::path place_;
  bool mounted_ = false;
};

}  // namespace palpate
