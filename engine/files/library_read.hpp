// SPDX-License-Identifier: Apache-2.0
// engine/files/library_read.hpp: reads a file with its format's library alone; `bench load` compares loadVolume with
// it. Any thread. Cost: the library's.
#pragma once

#include <cstddef>
#include <string>

namespace palpate {

// Reads NRRD, NIfTI and MetaImage with ITK into plain memory, and every grid of a .vdb with OpenVDB, completely.
// Returns the bytes of what was read, which is thrown away. Throws Error(kBadInput) for another suffix and for a file
// that the library cannot read.
[[nodiscard]] std::size_t readWithLibraryAlone(const std::string& name);

}  // namespace palpate
