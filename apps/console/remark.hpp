// SPDX-License-Identifier: Apache-2.0
// apps/console/remark.hpp: remarks on an input that a user should know of. Any thread.
#pragma once

#include <string>

namespace palpate {

// Writes "palpate: SOURCE: REMARK" as one line on stderr; nothing for an empty remark. Never throws: a remark that
// cannot be written is lost.
void tellRemark(const std::string& source, const std::string& remark) noexcept;

}  // namespace palpate
