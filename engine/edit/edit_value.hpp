// SPDX-License-Identifier: Apache-2.0
// engine/edit/edit_value.hpp: one `key=value` of an edit's text, and the types that its value may be read as. Any
// thread.
//
// Each function throws Error(kBadInput) that says what the text holds, what is wrong and what may be given.
#pragma once

#include <string>
#include <string_view>

#include "base/vec.hpp"

namespace palpate {

struct EditValue {
  std::string_view key, text;
  const std::string& where;  // names the whole text, for messages: "--do 'add:radius=2mm'"

  [[nodiscard]] double number(double lowest, double highest) const;
  [[nodiscard]] double length() const;  // positive; in mm where the text has no unit [m]
  [[nodiscard]] Vec3 place() const;     // three lengths of any sign; a unit behind the last one holds for all three [m]
  [[nodiscard]] Vec3 numbers() const;   // three plain numbers [-]
};

}  // namespace palpate
