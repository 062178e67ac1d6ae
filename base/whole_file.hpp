// SPDX-License-Identifier: Apache-2.0
// base/whole_file.hpp: the content of a plain file that a user named, for files that fit into memory.
//
// Never waits for anybody, as the reader of a pipe does. Any thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>

namespace palpate {

// `what`: in messages, "the recording". Throws Error: kNotFound if there is none or it may not be read; kBadInput for a
// folder or anything else that is no plain file, and for one of more than `most_bytes`; kIo if it cannot be opened or
// read for another reason; kOutOfMemory if no descriptor is left.
[[nodiscard]] std::string wholeFile(const std::filesystem::path& file, const std::string& what,
                                    std::uint64_t most_bytes = std::numeric_limits<std::uint64_t>::max());

}  // namespace palpate
