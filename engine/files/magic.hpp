// SPDX-License-Identifier: Apache-2.0
// engine/files/magic.hpp: what a file is by its first bytes, whatever its name says. Private to engine/files.
#pragma once

#include <cstddef>
#include <string>

namespace palpate {

// A name from volumeFormats(), "DICOM" for one slice, or "" if the bytes say nothing. gzip files are opened to look
// inside. Cost: reads at most a few KiB. Any thread. Throws as headOf.
[[nodiscard]] std::string formatByContent(const std::string& path, const std::string& source);

// The first `count` bytes of a file, fewer where it ends, taken out of gzip if they lie in it; "" where the gzip is
// damaged. Throws Error(kIo, `source`) if the file cannot be opened or read: that is no damage.
[[nodiscard]] std::string headOf(const std::string& path, std::size_t count, const std::string& source);

}  // namespace palpate
