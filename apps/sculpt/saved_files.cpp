// SPDX-License-Identifier: Apache-2.0
#include "apps/sculpt/saved_files.hpp"

namespace palpate {
namespace {

// Two names of one file are one path, where its folder exists.
std::filesystem::path whole(const std::filesystem::path& file) {
  std::error_code unknown;
  std::filesystem::path path = std::filesystem::weakly_canonical(file, unknown);
  return unknown ? std::filesystem::absolute(file, unknown).lexically_normal() : path;
}

}  // namespace

bool SavedFiles::isForeign(const std::filesystem::path& file) const {
  std::error_code unknown;  // what cannot be looked at cannot be written either, which is said then
  const auto status = std::filesystem::symlink_status(file, unknown);
  return std::filesystem::exists(status) && !files_.contains(whole(file));
}

void SavedFiles::wrote(const std::filesystem::path& file) {
  files_.insert(whole(file));
}

}  // namespace palpate
