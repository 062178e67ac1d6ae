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
  kValueByte,    // a byte of the values is changed
  kCut,          // the end of the file is missing
  kSurplus,      // there are more bytes at the end
  kMiddleLost,   // bytes of the values are missing
  kHeaderByte,   // a byte of the header is changed
  kHeaderValue,  // a number of the header becomes NaN, infinite, 3e38, huge, negative, nothing, or 1,000 letters
  kLineLost,     // a line of a text header is missing
  kLineTwice,    // a line of a text header comes twice
  kLineEmpty,    // an empty line is put into a text header
  kMany          // several of these, in any place
};
inline constexpr std::array kDamages = {Damage::kValueByte,  Damage::kCut,        Damage::kSurplus,
                                        Damage::kMiddleLost, Damage::kHeaderByte, Damage::kHeaderValue,
                                        Damage::kLineLost,   Damage::kLineTwice,  Damage::kLineEmpty};

[[nodiscard]] const char* nameOf(Damage damage);  // a column of the table

// Whether this damage can be done to such a file: only text headers have lines.
[[nodiscard]] bool applies(Damage damage, const WholeFile& file);

// Whether the reader must refuse this damage, by what the format promises.
[[nodiscard]] bool mustBeSeen(Damage damage, const WholeFile& file);

// The damaged bytes. They always differ from `whole`.
[[nodiscard]] std::string damaged(const std::string& whole, Damage damage, const WholeFile& file,
                                  std::mt19937_64& random);

}  // namespace palpate::damage
