// SPDX-License-Identifier: Apache-2.0
// tests/support/progress_words.hpp: the stages that a piece of work announces, where there is no terminal.
#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include "apps/console/progress.hpp"

namespace palpate {

class ProgressWords {
 public:
  ProgressWords() : stream_(std::tmpfile()), progress_(stream_, 1e9) {}
  ~ProgressWords() { static_cast<void>(std::fclose(stream_)); }
  ProgressWords(const ProgressWords&) = delete;
  ProgressWords& operator=(const ProgressWords&) = delete;

  [[nodiscard]] Progress& progress() noexcept { return progress_; }
  // In order, without those of single passes on the device.
  [[nodiscard]] std::vector<std::string> stages() const {
    std::rewind(stream_);
    std::vector<std::string> stages;
    std::string line;
    for (int c = std::fgetc(stream_); c != EOF; c = std::fgetc(stream_)) {
      if (c != '\n') {
        line += static_cast<char>(c);
        continue;
      }
      if (!line.starts_with("computing on Vulkan: ")) stages.push_back(line);
      line.clear();
    }
    return stages;
  }

 private:
  std::FILE* stream_;
  Progress progress_;
};

}  // namespace palpate
