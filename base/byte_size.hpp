// SPDX-License-Identifier: Apache-2.0
// base/byte_size.hpp: sizes of memory as users write them: 1024, 512MiB, 2GiB, 1GB. Any thread.
#pragma once

#include <cstdint>
#include <string>

namespace palpate {

// A whole number or a decimal fraction, and a unit: none or B; kB, MB, GB, TB (powers of 1000); KiB, MiB, GiB, TiB
// (powers of 1024). Case does not matter. The result is rounded down to whole bytes. Throws Error(kBadInput), which
// names `input`, on text without a number, a negative number, another unit, and 2^63 bytes or more.
[[nodiscard]] std::uint64_t byteSize(const std::string& text, const std::string& input);

// The reverse of byteSize(), in the largest power of 1024 that gives a whole number: "2GiB", "1536MiB".
[[nodiscard]] std::string byteSizeText(std::uint64_t bytes);

// For messages and tables.
[[nodiscard]] std::string bytesInWords(std::uint64_t bytes);  // three digits: "512 B", "1.5 MiB", "1.21 GiB"
[[nodiscard]] std::string inMiB(std::uint64_t bytes);         // one decimal, for columns that are summed: "1536.0 MiB"
[[nodiscard]] std::string wholeMiB(std::uint64_t bytes);      // rounded up, valid as the value of an option: "16MiB"

}  // namespace palpate
