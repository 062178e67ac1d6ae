// SPDX-License-Identifier: Apache-2.0
// engine/files/text_stored.hpp: where the header of a NRRD or MetaImage file says that its values lie. Private to
// engine/files. Any thread.
//
// Both throw Error: kBadInput for a header with a fault or with an impossible field; kNotFound if a file of values, or
// the file that lists them, does not exist.
#pragma once

#include <string>

#include "engine/files/stored_values.hpp"
#include "engine/files/text_header.hpp"

namespace palpate {

// `value_bytes`: the size of one value. bzip2 is refused: ITK's NRRD library is built without it.
[[nodiscard]] StoredValues nrrdStored(const TextHeader& header, const std::string& path, std::size_t value_bytes,
                                      const std::string& source);
[[nodiscard]] StoredValues metaStored(const TextHeader& header, const std::string& path, const std::string& source);

}  // namespace palpate
