// SPDX-License-Identifier: Apache-2.0
// engine/files/library_read.hpp: a file read by its format's library alone, as `bench load` holds against loadVolume.
// Any thread. Cost: what the library takes.
#pragma once

#include <cstddef>
#include <string>

namespace palpate {

// NRRD, NIfTI and MetaImage, by ITK, into plain memory; .vdb, by OpenVDB, every grid of it, nothing left for later.
// Returns how many bytes that took; they are thrown away. Throws Error(kBadInput) for another suffix and what the
// library cannot read.
[[nodiscard]] std::size_t readWithLibraryAlone(const std::string& name);

}  // namespace palpate
