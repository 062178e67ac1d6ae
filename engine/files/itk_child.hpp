// SPDX-License-Identifier: Apache-2.0
// engine/files/itk_child.hpp: what ITK and the libraries under it read, in a child process (base/child_process.hpp).
// Private to engine/files.
//
// On damaged files NIfTI's and NRRD's libraries crash or loop for ever, and Debian builds GDCM with its assertions on.
// `source` is the input that messages name. Set-up thread. Cost: a fork, and what ITK takes.
#pragma once

#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "engine/files/itk_file.hpp"

namespace palpate {

// What a file says of itself.
struct ItkFacts {
  ItkHeader header;
  std::map<std::string, std::string> tags;
};

// Throws Error(kBadInput) for a file that ITK cannot read, crashes on or takes too long over.
[[nodiscard]] ItkHeader readItkHeader(ItkReader reader, const std::string& path, const std::string& source);

// The same for a series of files, in one child. `refuse` is called with the number of the first file that cannot be
// read, and with words for a message; it throws.
using RefuseFile = std::function<void(std::size_t n, const std::string& words)>;
[[nodiscard]] std::vector<ItkFacts> readItkSeries(ItkReader reader, const std::vector<std::string>& paths,
                                                  const std::string& source, const RefuseFile& refuse);
// File n's values go into the nth of `values`, which is shared with children (base/shared_buffer.hpp) and has the size
// that the file's header asks for.
void readItkSeriesValues(ItkReader reader, const std::vector<std::string>& paths,
                         const std::vector<std::span<char>>& values, const std::string& source,
                         const RefuseFile& refuse);

}  // namespace palpate
