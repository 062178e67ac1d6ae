// SPDX-License-Identifier: Apache-2.0
// apps/bench/scratch_folder.hpp: an empty folder for what a benchmark writes, gone with its owner. Any thread.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

#include "base/error.hpp"

namespace palpate {

class ScratchFolder {
 public:
  // Throws Error(kIo) where none can be made.
  ScratchFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "palpate_bench_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) {
      throw Error(Error::Code::kIo, name, "no folder can be made there", "set TMPDIR to a folder that may be written");
    }
    path_ = name;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace palpate
