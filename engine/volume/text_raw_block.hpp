// SPDX-License-Identifier: Apache-2.0
// engine/volume/text_raw_block.hpp: where the values of a NRRD or MetaImage file lie, if nothing in its header packs,
// moves or turns them; nothing if the header says anything in a way that only the format's library may understand.
// Private to engine/volume. Any thread.
#pragma once

#include <optional>
#include <string>

#include "engine/volume/raw_block.hpp"
#include "engine/volume/text_header.hpp"

namespace palpate {

[[nodiscard]] std::optional<RawBlock> nrrdRawBlock(const TextHeader& header, const std::string& path);
[[nodiscard]] std::optional<RawBlock> metaRawBlock(const TextHeader& header, const std::string& path);

}  // namespace palpate
