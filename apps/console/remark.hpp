// SPDX-License-Identifier: Apache-2.0
// apps/console/remark.hpp: what a user should know of an input and did not ask. Any thread.
#pragma once

#include <string>

namespace palpate {

// "palpate: SOURCE: REMARK" as one line on stderr; nothing for an empty remark. Never throws: a remark that cannot be
// written is lost.
void tellRemark(const std::string& source, const std::string& remark) noexcept;

}  // namespace palpate
