// SPDX-License-Identifier: Apache-2.0
// base/json_text.hpp: JSON as the text of a file. Any thread.
#pragma once

#include <string>

namespace palpate {

// Indented by two, with a newline at the end. Names of files and texts of scanners may be no UTF-8, which JSON has to
// be: what is not becomes U+FFFD. `json`: of nlohmann's library, in either order of keys.
template <class Json>
[[nodiscard]] std::string jsonFileText(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace palpate
