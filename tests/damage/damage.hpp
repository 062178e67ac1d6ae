// SPDX-License-Identifier: Apache-2.0
// tests/damage/damage.hpp: ways in which a file is damaged. The same seed gives the same damage everywhere. One thread.
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <string>

#include "tests/damage/whole_files.hpp"

namespace palpate::damage {

enum class Damage {
  kValueByte,    // a byte among the values, changed
  kCut,          // the end is missing
  kSurplus,      // bytes more at the end
  kMiddleLost,   // bytes missing among the values
  kHeaderByte,   // a byte of the header, changed
  kHeaderValue,  // a number of it made NaN, infinite, 3e38, huge, negative, nothing, or 1,000 letters
  kLineLost,     // a line of a header of text
  kLineTwice,
  kLineEmpty,  // put in
  kMany        // several of them, in any place
};
inline constexpr std::array kDamages = {Damage::kValueByte,  Damage::kCut,        Damage::kSurplus,
                                        Damage::kMiddleLost, Damage::kHeaderByte, Damage::kHeaderValue,
                                        Damage::kLineLost,   Damage::kLineTwice,  Damage::kLineEmpty};

[[nodiscard]] const char* nameOf(Damage damage);  // a column of the table

// Whether such a file can be damaged so: only headers of text have lines.
[[nodiscard]] bool applies(Damage damage, const WholeFile& file);

// Whether the format has to tell it, by what it promises.
[[nodiscard]] bool mustBeSeen(Damage damage, const WholeFile& file);

// Never the same bytes as before.
[[nodiscard]] std::string damaged(const std::string& whole, Damage damage, const WholeFile& file,
                                  std::mt19937_64& random);

}  // namespace palpate::damage
