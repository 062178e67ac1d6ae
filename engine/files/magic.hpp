// SPDX-License-Identifier: Apache-2.0
// engine/files/magic.hpp: recognises a file's format by its first bytes, whatever its name says. Private to
// engine/files.
#pragma once

#include <cstddef>
#include <string>

namespace palpate {

// A name from volumeFormats(), "DICOM" for one slice, or "" if the bytes fit no format. Looks inside gzip. Cost: reads
// a few KiB at most. Any thread. Throws as headOf does.
[[nodiscard]] std::string formatByContent(const std::string& path, const std::string& source);

// The first `count` bytes of a file, or all if it has fewer. A gzip file is unpacked; "" if its gzip is damaged. Throws
// Error(kIo, `source`) if the file cannot be opened or read.
[[nodiscard]] std::string headOf(const std::string& path, std::size_t count, const std::string& source);

}  // namespace palpate
