// SPDX-License-Identifier: Apache-2.0
// apps/console/other_file.hpp: a verb that reads one file and writes another must not write over what it reads.
#pragma once

#include <string>

namespace palpate {

// Throws Error(kBadInput) where `out` is the input, by whatever way, or a file of the input's folder of slices. `in` as
// loadVolume takes it.
void checkOther(const std::string& in, const std::string& out);

}  // namespace palpate
