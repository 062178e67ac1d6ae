// SPDX-License-Identifier: Apache-2.0
// engine/files/itk_child.hpp: reads a file's header with ITK and the libraries under it, in a child process
// (base/child_process.hpp). Private to engine/files.
//
// Why a child process: on damaged files the libraries of NIfTI and NRRD crash or loop for ever. Set-up thread. Cost: a
// fork, and ITK's own.
#pragma once

#include <string>

#include "engine/files/itk_file.hpp"

namespace palpate {

// `source`: the name of the input in messages. Throws Error(kBadInput) for a file that ITK cannot read, crashes on or
// takes too long over; Error(kIo) for one that cannot be opened.
[[nodiscard]] ItkHeader readItkHeader(ItkReader reader, const std::string& path, const std::string& source);

}  // namespace palpate
