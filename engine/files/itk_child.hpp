// SPDX-License-Identifier: Apache-2.0
// engine/files/itk_child.hpp: reads files with ITK and the libraries under it, in a child process
// (base/child_process.hpp). Private to engine/files.
//
// Why a child process: on damaged files the libraries of NIfTI and NRRD crash or loop for ever, and Debian builds GDCM
// with its assertions on. `source` is the name of the input in messages. Set-up thread. Cost: a fork, and ITK's own.
#pragma once

#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "engine/files/itk_file.hpp"

namespace palpate {

// A file's header and, for DICOM, its values by tag ("0020|000e").
struct ItkFacts {
  ItkHeader header;
  std::map<std::string, std::string> tags;
};

// Throws Error(kBadInput) for a file that ITK cannot read, crashes on or takes too long over.
[[nodiscard]] ItkHeader readItkHeader(ItkReader reader, const std::string& path, const std::string& source);

// The same for a series of files, in one child process. `refuse` must throw. It is called with the number of the first
// file that cannot be read, and with words for a message.
using RefuseFile = std::function<void(std::size_t n, const std::string& words)>;
[[nodiscard]] std::vector<ItkFacts> readItkSeries(ItkReader reader, const std::vector<std::string>& paths,
                                                  const std::string& source, const RefuseFile& refuse);
// Reads the values of file n into values[n]. That memory must be shared with child processes (base/shared_buffer.hpp)
// and have the size that the file's header asks for.
void readItkSeriesValues(ItkReader reader, const std::vector<std::string>& paths,
                         const std::vector<std::span<char>>& values, const std::string& source,
                         const RefuseFile& refuse);

}  // namespace palpate
