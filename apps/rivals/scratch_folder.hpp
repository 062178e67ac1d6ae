// SPDX-License-Identifier: Apache-2.0
// apps/rivals/scratch_folder.hpp: an empty temporary folder for a bench or its rivals. The destructor removes it. Any
// thread.
#pragma once

#include <filesystem>
#include <optional>
#include <system_error>

#include "base/draft_folder.hpp"
#include "base/error.hpp"

namespace palpate {

class ScratchFolder {
 public:
  // Throws Error(kIo) if no folder can be made.
  ScratchFolder() {
    const std::filesystem::path parent = std::filesystem::temp_directory_path();
    try {
      folder_.emplace(parent, "palpate_bench_");
    } catch (const std::system_error& failure) {
      throw Error(Error::Code::kIo, parent.string(), "no folder can be made there (" + failure.code().message() + ")",
                  "set TMPDIR to a folder that may be written");
    }
  }
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return folder_->path(); }

 private:
  std::optional<DraftFolder> folder_;
};

}  // namespace palpate
