// SPDX-License-Identifier: Apache-2.0
// engine/files/vdb_checksum.hpp: OpenVDB's format has no checksum. Palpate writes one after the last grid, where no
// reader of the format looks: 8 bytes "palpate1", the CRC-32C of all bytes before them, and its complement, 4 bytes
// each, little-endian. Private to engine/files. Any thread.
#pragma once

#include <cstdint>
#include <string>

namespace palpate {

enum class VdbChecksum {
  kMissing,  // another program wrote the file, or an older Palpate; or its last bytes are lost
  kHolds,
  kFails
};

// Reads the whole file where it has one. Throws Error(kIo, `source`) where it cannot be read.
[[nodiscard]] VdbChecksum checkVdbChecksum(const std::string& path, const std::string& source);

// The 16 bytes at the end of a file whose other bytes have this checksum.
[[nodiscard]] std::string vdbChecksumBytes(std::uint32_t crc);

}  // namespace palpate
