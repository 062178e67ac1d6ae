// SPDX-License-Identifier: Apache-2.0
// apps/edit/edit_words.hpp: the result of `palpate edit` as text and as JSON. Any thread.
#pragma once

#include <nlohmann/json.hpp>

#include "apps/edit/edit_job.hpp"

namespace palpate {

// A table for the terminal.
[[nodiscard]] std::string editWords(const EditRequest& request, const EditResult& result);

// docs/edits.md lists the keys with their units.
[[nodiscard]] nlohmann::ordered_json editJson(const EditRequest& request, const EditResult& result);

}  // namespace palpate
