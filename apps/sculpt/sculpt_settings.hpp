// SPDX-License-Identifier: Apache-2.0
// apps/sculpt/sculpt_settings.hpp: what the window remembers from one day to the next, as JSON. One thread.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/sculpt/brush_choice.hpp"
#include "apps/sculpt/pointer_tool.hpp"

namespace palpate {

struct SculptSettings {
  bool dark = true;
  double scale = 0;                // of text and panels; 0: the display's
  int width = 1280, height = 720;  // of the window, at least kLeastWidth x kLeastHeight
  static constexpr int kLeastWidth = 320, kLeastHeight = 240;
  BrushChoice brush = {};
  PointerReach reach = {};
  std::vector<std::string> recent = {};  // volumes, the newest first

  static constexpr std::size_t kMostRecent = 10;
  void opened(std::string volume);  // puts it first
};

// The settings of a file. What it lacks, or has out of range, is as by default. A file that is no JSON gives the
// defaults, and `trouble` says so; without a file there is no trouble.
[[nodiscard]] SculptSettings readSettings(const std::filesystem::path& file, std::string& trouble);
// Makes the folder too. Throws Error(kIo).
void writeSettings(const SculptSettings& settings, const std::filesystem::path& file);

}  // namespace palpate
