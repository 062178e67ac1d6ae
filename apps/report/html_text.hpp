// SPDX-License-Identifier: Apache-2.0
// apps/report/html_text.hpp: escapes text for an HTML page. Any thread; one pass each.
#pragma once

#include <string>
#include <string_view>

namespace palpate {

// For element content and quoted attributes: & < > " ' become entities, control characters become spaces.
[[nodiscard]] std::string escapeHtml(std::string_view text);

// JSON inside a script element: '<' becomes \u003c, so that no text can end the element.
[[nodiscard]] std::string escapeScriptJson(std::string json);

[[nodiscard]] std::string base64(std::string_view bytes);

// A key of the summary for people: "press_depth_m" -> "press depth [m]".
[[nodiscard]] std::string keyInWords(std::string_view key);

}  // namespace palpate
