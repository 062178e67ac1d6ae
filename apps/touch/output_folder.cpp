// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/output_folder.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <system_error>
#include <vector>

#include "base/error.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& path, const std::string& reason) {
  throw Error(Error::Code::kIo, path, "nothing can be written there (" + reason + ")",
              "choose another folder with --out");
}

const std::string& checked(const std::string& path) {
  if (path.empty()) refuse("--out ''", "it names no folder");
  return path;
}

// Without a '/' at its end, whose parent would be itself.
fs::path plain(const fs::path& path) {
  std::error_code ignored;
  const fs::path whole = fs::absolute(path, ignored).lexically_normal();
  return whole.has_filename() ? whole : whole.parent_path();
}

}  // namespace

MadeFolders::MadeFolders(const fs::path& path) : last_(plain(path)) {
  std::error_code ignored;
  for (fs::path at = last_; at.has_relative_path() && !fs::exists(fs::symlink_status(at, ignored));
       at = at.parent_path()) {
    first_ = at;
  }
}

MadeFolders::~MadeFolders() {
  std::error_code ignored;
  for (fs::path at = last_; !first_.empty(); at = at.parent_path()) {
    const fs::file_status status = fs::symlink_status(at, ignored);
    // Removing fails, as it should, if the folder holds anything.
    if (fs::exists(status) && !(fs::is_directory(status) && fs::remove(at, ignored))) return;
    if (at == first_) return;
  }
}

OutputFolder::OutputFolder(const std::string& path) : path_(checked(path)), made_(path_) {
  std::error_code error;
  fs::create_directories(path_, error);
  if (error) refuse(path, error.message());
  if (!fs::is_directory(path_)) refuse(path, "it is not a folder");
  std::string drafts = (path_ / ".palpate-XXXXXX").string();
  if (mkdtemp(drafts.data()) == nullptr) refuse(path, std::generic_category().message(errno));
  drafts_ = drafts;
}

OutputFolder::~OutputFolder() {
  std::error_code ignored;
  fs::remove_all(drafts_, ignored);
}

void OutputFolder::publish(const char* first) {
  std::vector<fs::path> names;
  for (const auto& entry : fs::directory_iterator(drafts_)) {
    names.push_back(entry.path().filename());
    std::error_code ignored;
    const fs::path target = path_ / names.back();
    const fs::file_status status = fs::status(target, ignored);
    if (fs::exists(status) && !fs::is_regular_file(status)) {
      throw Error(Error::Code::kIo, target.string(), "it is not a plain file and will not be replaced",
                  "move it away or choose another folder with --out");
    }
  }
  std::stable_partition(names.begin(), names.end(), [&](const fs::path& name) { return name == first; });
  for (const fs::path& name : names) {
    std::error_code error;
    fs::rename(drafts_ / name, path_ / name, error);
    if (error) refuse((path_ / name).string(), error.message());
  }
  for (const fs::path& name : left_out_) {
    std::error_code ignored;
    if (fs::is_regular_file(path_ / name, ignored)) fs::remove(path_ / name, ignored);
  }
}

}  // namespace palpate
