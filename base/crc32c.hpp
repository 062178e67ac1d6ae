// SPDX-License-Identifier: Apache-2.0
// base/crc32c.hpp: CRC-32C (Castagnoli), the checksum of journals and of the OpenVDB files that Palpate writes. It is
// that of iSCSI, ext4 and SSE4.2 (RFC 3720, B.4). Any thread. Cost: some 0.15 ns a byte with SSE4.2, 2 ns without.
#pragma once

#include <cstdint>
#include <string_view>

namespace palpate {

// `before`: the checksum of the preceding bytes; 0 at the beginning.
[[nodiscard]] std::uint32_t crc32c(std::string_view bytes, std::uint32_t before = 0) noexcept;

// The same by a table, without the processor's CRC instruction. For processors that have none, and for tests.
[[nodiscard]] std::uint32_t crc32cByTable(std::string_view bytes, std::uint32_t before = 0) noexcept;

}  // namespace palpate
