// SPDX-License-Identifier: Apache-2.0
// engine/edit/edit_value.hpp: one `key=value` of an edit's text, and what it may be read as. Any thread.
//
// Each reading throws Error(kBadInput) with what the text says, what is wrong and what may be given.
#pragma once

#include <string>
#include <string_view>

#include "base/vec.hpp"

namespace palpate {

struct EditValue {
  std::string_view key, text;
  const std::string& where;  // the text that it stands in, for messages: "--do 'add:radius=2mm'"

  [[nodiscard]] double number(double lowest, double highest) const;
  [[nodiscard]] double length() const;  // above 0; mm where no unit is given [m]
  [[nodiscard]] Vec3 place() const;     // three lengths of any sign, the unit behind the last holds for all [m]
  [[nodiscard]] Vec3 numbers() const;   // three
};

}  // namespace palpate
