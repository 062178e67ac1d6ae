// SPDX-License-Identifier: Apache-2.0
// engine/files/vdb_claim.hpp: how much memory an OpenVDB file says that its grids take. OpenVDB notes it with each grid
// that it writes ("file_mem_bytes"), so a file that packs well can be refused before it is unpacked. Private to
// engine/files. Any thread.
#pragma once

#include <string>

namespace palpate {

// The sum over all grids [byte]; 0 where nothing is said. A damaged file may say anything. Cost: reads the whole file.
// Throws Error(kIo, `source`) where it cannot be opened.
[[nodiscard]] double vdbClaimedBytes(const std::string& path, const std::string& source);

}  // namespace palpate
