// SPDX-License-Identifier: Apache-2.0
// tests/fuzz/scratch_file.hpp: a file for parsers that read files. It is written anew for every input, in a folder that
// is removed with the object.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

#include <fcntl.h>
#include <unistd.h>

#include "fuzz_target.hpp"

namespace palpate::fuzz {

class ScratchFile {
 public:
  explicit ScratchFile(const std::string& name) {
    std::string folder = (std::filesystem::temp_directory_path() / "palpate_fuzz_XXXXXX").string();
    require(mkdtemp(folder.data()) != nullptr, "there is no temporary folder");
    folder_ = folder;
    path_ = folder_ / name;
  }
  ~ScratchFile() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  // Makes a new file each time: some file systems flush a file to the disk at once if it is truncated and written
  // again.
  void write(std::string_view bytes) const {
    unlink(path_.c_str());
    const int descriptor = open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    const bool written = ::write(descriptor, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size());
    require(close(descriptor) == 0 && written, "the scratch file cannot be written");
  }
  [[nodiscard]] std::string path() const { return path_.string(); }
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path folder_, path_;
};

}  // namespace palpate::fuzz
