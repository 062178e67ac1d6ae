// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/output_folder.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <system_error>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/report/summary.hpp"
#include "base/error.hpp"
#include "base/outside_text.hpp"
#include "base/part_file.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuseFolder(const std::string& path, const std::string& reason) {
  throw Error(Error::Code::kIo, path, "nothing can be written there (" + reason + ")",
              "choose another folder with --out");
}

const std::string& checked(const std::string& path) {
  if (path.empty()) refuseFolder("--out ''", "it names no folder");
  return path;
}

// Removes a '/' at the end, since the parent of "a/" would be "a".
fs::path plain(const fs::path& path) {
  std::error_code ignored;
  const fs::path whole = fs::absolute(path, ignored).lexically_normal();
  return whole.has_filename() ? whole : whole.parent_path();
}

// Not committed yet. The file that is meant may lie on another file system, where nothing can be moved from here.
std::unique_ptr<AtomicFile> copied(const fs::path& draft, const fs::path& target) {
  auto file = std::make_unique<AtomicFile>(target);
  std::ifstream in(draft, std::ios::binary);
  std::vector<char> block(std::size_t{1} << 20U);
  while (in) {
    in.read(block.data(), static_cast<std::streamsize>(block.size()));
    file->write({block.data(), static_cast<std::size_t>(in.gcount())});
  }
  if (!in.eof()) refuseFolder(target.string(), "its draft cannot be read");
  return file;
}

// The names of the files that a run's summary lists. By name only, since the folder may have been moved.
std::vector<std::string> listedBy(const fs::path& summary) {
  std::error_code ignored;
  if (!fs::is_regular_file(summary, ignored)) return {};
  std::ifstream in(summary);
  const nlohmann::json run = nlohmann::json::parse(in, nullptr, false);
  if (!run.is_object()) return {};
  const nlohmann::json schema = run.value("schema", nlohmann::json());
  if (!schema.is_string() || !schema.get<std::string>().starts_with(kSummaryName)) return {};
  std::vector<std::string> names = {summary.filename().string()};
  if (const auto files = run.find("files"); files != run.end() && files->is_array()) {
    for (const auto& file : *files) {
      if (file.is_string()) names.push_back(fs::path(file.get<std::string>()).filename().string());
    }
  }
  return names;
}

}  // namespace

std::vector<std::string> foreignResults(const fs::path& folder) {
  const std::vector<std::string> ours = listedBy(folder / "summary.json");
  std::vector<std::string> foreign;
  for (const char* name : kRunResults) {
    std::error_code ignored;
    const bool is_file = fs::is_regular_file(folder / name, ignored);
    if (is_file && std::find(ours.begin(), ours.end(), name) == ours.end()) foreign.emplace_back(name);
  }
  return foreign;
}

void refuseForeignResults(const fs::path& folder) {
  const std::vector<std::string> foreign = foreignResults(folder);
  if (foreign.empty()) return;
  throw Error(Error::Code::kBadInput, (folder / foreign.front()).string(),
              "it is not a result of palpate and would be replaced by one",
              "move it away or choose another folder with --out");
}

MadeFolders::MadeFolders(const fs::path& path) : last_(plain(path)) {
  std::error_code ignored;
  std::vector<fs::path> missing;  // innermost first
  for (fs::path at = last_; at.has_relative_path() && !fs::exists(fs::symlink_status(at, ignored));
       at = at.parent_path()) {
    missing.push_back(first_ = at);
  }
  for (auto at = missing.rbegin(); at != missing.rend(); ++at) leftovers_.push_back(Leftover::emptyFolder(*at));
}

MadeFolders::~MadeFolders() {
  std::error_code ignored;
  for (fs::path at = last_; !first_.empty(); at = at.parent_path()) {
    const fs::file_status status = fs::symlink_status(at, ignored);
    // Fails, as it should, if the folder holds anything.
    if (fs::exists(status) && !(fs::is_directory(status) && fs::remove(at, ignored))) return;
    if (at == first_) return;
  }
}

OutputFolder::OutputFolder(const std::string& path) : path_(checked(path)), made_(path_) {
  std::error_code error;
  fs::create_directories(path_, error);
  if (error) refuseFolder(path, error.message());
  if (!fs::is_directory(path_)) refuseFolder(path, "it is not a folder");
  sweepPartFiles(path_);
  try {
    drafts_.emplace(path_, ".palpate-");
  } catch (const std::system_error& failure) {
    refuseFolder(path, failure.code().message());
  }
}

void OutputFolder::write(const char* name, const std::function<void(const fs::path&)>& work) const {
  const fs::path path = draft(name);
  try {
    work(path);
  } catch (const Error& error) {
    if (error.input() != oneLine(path.string())) throw;
    throw Error(error.code(), file(name).string(), error.reason(), error.remedy());
  }
}

OutputFolder::Target OutputFolder::targetOf(const fs::path& name) const {
  const fs::path target = path_ / name;
  std::error_code ignored;
  const fs::file_status status = fs::status(target, ignored);
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    throw Error(Error::Code::kIo, target.string(), "it is not a plain file and will not be replaced",
                "move it away or choose another folder with --out");
  }
  Target made{target, drafts_->path() / name, nullptr};
  if (fs::is_symlink(fs::symlink_status(target, ignored))) made.behind_link = copied(made.draft, target);
  return made;
}

// Most of what may fail is done before anything is moved.
void OutputFolder::publish(const char* first) {
  std::vector<Target> targets;
  for (const auto& entry : fs::directory_iterator(drafts_->path()))
    targets.push_back(targetOf(entry.path().filename()));
  std::stable_partition(targets.begin(), targets.end(), [&](const Target& t) { return t.file.filename() == first; });
  for (Target& target : targets) {
    std::error_code error;
    if (target.behind_link) {
      target.behind_link->commit();
    } else {
      std::error_code ignored;  // who may read the file that is replaced may read the new one
      if (const fs::file_status old = fs::status(target.file, ignored); fs::exists(old))
        fs::permissions(target.draft, old.permissions(), ignored);
      fs::rename(target.draft, target.file, error);
    }
    if (error) refuseFolder(target.file.string(), error.message());
  }
  for (const fs::path& name : left_out_) {
    std::error_code ignored;
    // Of a link, the file behind it is removed. The link stays, for the next run with such a result.
    const fs::path file = fs::weakly_canonical(path_ / name, ignored);
    if (fs::is_regular_file(file, ignored)) fs::remove(file, ignored);
  }
}

}  // namespace palpate
