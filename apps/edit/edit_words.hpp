// SPDX-License-Identifier: Apache-2.0
// apps/edit/edit_words.hpp: what `palpate edit` did, for people and for programs. Any thread.
#pragma once

#include <nlohmann/json.hpp>

#include "apps/edit/edit_job.hpp"

namespace palpate {

// A table for the terminal.
[[nodiscard]] std::string editWords(const EditRequest& request, const EditResult& result);

// Keys with their units; docs/edits.md.
[[nodiscard]] nlohmann::ordered_json editJson(const EditRequest& request, const EditResult& result);

}  // namespace palpate
