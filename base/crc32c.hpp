// SPDX-License-Identifier: Apache-2.0
// base/crc32c.hpp: the checksum of journals and of OpenVDB files that Palpate writes: CRC-32C (Castagnoli), as iSCSI,
// ext4 and SSE4.2 have it (RFC 3720, B.4). Any thread. Cost: some 0.15 ns a byte with SSE4.2, 2 ns without.
#pragma once

#include <cstdint>
#include <string_view>

namespace palpate {

// `before`: the checksum of what came before, to go on from; 0 to begin.
[[nodiscard]] std::uint32_t crc32c(std::string_view bytes, std::uint32_t before = 0) noexcept;

// The same without the processor's own instruction, whatever the processor.
[[nodiscard]] std::uint32_t crc32cByTable(std::string_view bytes, std::uint32_t before = 0) noexcept;

}  // namespace palpate
