// SPDX-License-Identifier: Apache-2.0
// engine/journal/crc32c.hpp: the checksum of journals: CRC-32C (Castagnoli), as iSCSI, ext4 and SSE4.2 have it
// (RFC 3720, B.4). Any thread. Cost: some 2 ns a byte.
#pragma once

#include <cstdint>
#include <string_view>

namespace palpate {

// `before`: the checksum of what came before, to go on from; 0 to begin.
[[nodiscard]] std::uint32_t crc32c(std::string_view bytes, std::uint32_t before = 0) noexcept;

}  // namespace palpate
