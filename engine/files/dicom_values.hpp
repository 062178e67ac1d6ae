// SPDX-License-Identifier: Apache-2.0
// engine/files/dicom_values.hpp: what the words of a DICOM image mean as densities. Private to engine/files. Any
// thread.
//
// A word holds a stored value in BitsStored bits, of which HighBit is the highest; other bits may hold anything. The
// density is the stored value times RescaleSlope plus RescaleIntercept, computed in double and rounded once to float,
// or what the table of ModalityLUTSequence gives for it. PhotometricInterpretation (MONOCHROME1: low values are shown
// white), windows and presentation tables concern the screen only and change no density.
// Source: DICOM PS3.5, 8.1.1 (pixel cells); PS3.3, C.7.6.3 (image pixel), C.7.5.1.1.2 (padding), C.11.1 (modality
// table).
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/files/dicom_slice.hpp"

namespace palpate {

// Which density a word stands for.
struct DicomValueRule {
  std::uint32_t bits_allocated = 16;  // of a word: 8, 16 or 32
  std::uint32_t bits_stored = 16;
  std::uint32_t high_bit = 15;
  bool is_signed = false;
  bool scaled = false;  // the file states slope and intercept
  double slope = 1;
  double intercept = 0;
  std::vector<std::uint16_t> table;  // in place of slope and intercept; empty: no table
  std::int64_t first_mapped = 0;     // the stored value to which the table's first entry belongs
  struct Range {
    std::int64_t lowest = 0, highest = 0;
  };
  std::optional<Range> padding;  // stored values that mark pixels outside the image

  [[nodiscard]] std::size_t wordBytes() const noexcept { return bits_allocated / 8; }
};

// The value of voxels that have none: padding, and what lies outside the slices. A NaN that is told from any other.
inline constexpr std::uint32_t kNoValueBits = 0x7fd0'0a1d;
[[nodiscard]] inline float noValue() noexcept {
  return std::bit_cast<float>(kNoValueBits);
}
[[nodiscard]] inline bool isNoValue(float value) noexcept {
  return std::bit_cast<std::uint32_t>(value) == kNoValueBits;
}

// The rule that a slice's file states. Throws Error(kBadInput) for colours, palettes and floating-point pixels; for
// words of other than 8, 16 or 32 bits, and bits that do not lie in them; for a slope or intercept that is not one
// finite number, a slope of 0, one of the two without the other; for a modality table beside them, of several items,
// with other than 8 to 16 bits, or with other than the entries that it announces; and for padding that is not one
// number.
[[nodiscard]] DicomValueRule valueRuleOf(const DicomSlice& slice, const std::string& source);

// One rule for each slice. Throws as valueRuleOf() does, and if only some slices are scaled, or only some have a table.
[[nodiscard]] std::vector<DicomValueRule> valueRulesOf(const DicomSeries& series, const std::string& source);

// Whether some bit outside the stored ones is set, other than by the sign. Words are in the machine's byte order.
[[nodiscard]] bool hasOtherBits(const DicomValueRule& rule, std::span<const char> words);

// `words` in the machine's byte order, one for each of `densities`. Padding becomes noValue(), what is too large for a
// float becomes beyondFloat() (engine/field/finite_values.hpp).
void toDensities(const DicomValueRule& rule, std::span<const char> words, std::span<float> densities);

}  // namespace palpate
