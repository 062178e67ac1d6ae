// SPDX-License-Identifier: Apache-2.0
#include "apps/console/other_file.hpp"

#include <filesystem>

#include "base/error.hpp"

namespace palpate {

namespace fs = std::filesystem;

// Links and other ways to the same file count. A folder of slices must not lose one either.
void checkOther(const std::string& in, const std::string& out) {
  std::error_code ignored;
  if (!fs::exists(out, ignored)) return;
  const std::string path = fs::exists(in, ignored) ? in : in.substr(0, in.rfind('#'));
  const bool same = fs::equivalent(path, out, ignored);
  const fs::path folder = fs::absolute(out, ignored).parent_path();
  if (same || (fs::is_directory(path, ignored) && fs::equivalent(path, folder, ignored))) {
    throw Error(Error::Code::kBadInput, out, same ? "it is the input" : "it is a file of the input's folder",
                "write to another name");
  }
}

}  // namespace palpate
