// SPDX-License-Identifier: Apache-2.0
// apps/touch/output_folder.hpp: the folder that a run writes into.
#pragma once

#include <filesystem>
#include <string>

namespace palpate {

// Makes the folder if it is not there and proves, before any long work, that files can be written into it. Throws
// Error(kIo). A folder that was made stays only if something is written into it: see OutputFolder's destructor.
class OutputFolder {
 public:
  explicit OutputFolder(const std::string& path);
  ~OutputFolder();  // removes the folder again if this object made it and it is still empty
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  [[nodiscard]] std::filesystem::path file(const char* name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
  bool made_ = false;
};

}  // namespace palpate
