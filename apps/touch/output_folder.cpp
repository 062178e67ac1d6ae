// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/output_folder.hpp"

#include <unistd.h>

#include <cstdlib>
#include <system_error>

#include "base/error.hpp"

namespace palpate {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& reason) {
  throw Error(Error::Code::kIo, path.string(), "nothing can be written there (" + reason + ")",
              "choose another folder with --out");
}

}  // namespace

OutputFolder::OutputFolder(const std::string& path) : path_(path) {
  std::error_code error;
  made_ = std::filesystem::create_directories(path_, error);
  if (error) refuse(path_, error.message());
  if (!std::filesystem::is_directory(path_)) refuse(path_, "it is not a folder");
  std::string probe = (path_ / ".palpate-XXXXXX").string();
  const int descriptor = mkstemp(probe.data());
  if (descriptor < 0) refuse(path_, std::system_category().message(errno));
  close(descriptor);
  unlink(probe.c_str());
}

OutputFolder::~OutputFolder() {
  if (!made_) return;
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);  // fails, as it should, if the folder holds anything
}

}  // namespace palpate
