// SPDX-License-Identifier: Apache-2.0
// base/byte_size.hpp: sizes of memory as people write them: 1024, 512MiB, 2GiB, 1GB. Any thread.
#pragma once

#include <cstdint>
#include <string>

namespace palpate {

// A whole number or a decimal fraction, and a unit: none or B; kB, MB, GB, TB (powers of 1000); KiB, MiB, GiB, TiB
// (powers of 1024), in any case. Rounded down to whole bytes. Throws Error(kBadInput), which names `input`: no number,
// a negative one, another unit, 2^63 bytes or more.
[[nodiscard]] std::uint64_t byteSize(const std::string& text, const std::string& input);

}  // namespace palpate
