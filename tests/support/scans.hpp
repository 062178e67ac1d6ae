// SPDX-License-Identifier: Apache-2.0
// tests/support/scans.hpp: the real scans that PALPATE_DATA names.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

inline constexpr const char* kNoScans = "PALPATE_DATA names no folder of scans";

// By name; empty: none, and the test is to be skipped with kNoScans.
inline std::vector<std::filesystem::path> realScans() {
  const char* folder = std::getenv("PALPATE_DATA");
  std::vector<std::filesystem::path> scans;
  if (folder == nullptr) return scans;
  std::error_code missing;
  for (const auto& entry : std::filesystem::directory_iterator(folder, missing)) {
    const std::string name = entry.path().filename().string();
    if (name.ends_with(".nrrd") || name.ends_with(".nii.gz")) scans.push_back(entry.path());
  }
  std::sort(scans.begin(), scans.end());
  return scans;
}

}  // namespace palpate
