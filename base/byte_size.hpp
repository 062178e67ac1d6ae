// SPDX-License-Identifier: Apache-2.0
// base/byte_size.hpp: sizes of memory as a user writes them. Any thread; no cost.
#pragma once

#include <cstdint>
#include <string>

namespace palpate {

// "512MiB", "2 GiB", "1.5GiB", "65536": a number above 0 and B, KiB, MiB, GiB or TiB (in any case; also K, M, G, T and
// KB, MB, GB, TB, which mean the same); bytes without a unit. `input`: the flag or key, for the message. Throws
// Error(kBadInput): no such form, nothing, a part of a byte, more than 2^53 bytes.
[[nodiscard]] std::uint64_t byteSize(const std::string& text, const std::string& input);

// The same back, in the largest unit that gives a whole number: "2GiB", "1536MiB".
[[nodiscard]] std::string byteSizeText(std::uint64_t bytes);

}  // namespace palpate
