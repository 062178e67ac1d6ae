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
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/field/raw_values.hpp"
#include "engine/files/dicom_slice.hpp"

namespace palpate {

// Which density a word stands for.
struct DicomValueRule {
  std::uint32_t bits_allocated = 16;  // of a word: 8, 16 or 32
  std::uint32_t bits_stored = 16;
  std::uint32_t high_bit = 15;
  bool is_signed = false;
  bool has_slope = false, has_intercept = false;  // the file states them
  double slope = 1;
  double intercept = 0;
  std::shared_ptr<const std::vector<std::uint16_t>> table;  // in place of slope and intercept; null: no table
  std::int64_t first_mapped = 0;                            // the stored value to which the table's first entry belongs
  struct Range {
    std::int64_t lowest = 0, highest = 0;
  };
  std::optional<Range> padding;  // values that mark pixels outside the image
  bool padding_is_word = false;  // they are those of whole words; otherwise stored values

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

// One rule for each slice; frames of one file share its table. Throws Error(kBadInput) for colours, palettes and
// floating-point pixels; for words of other than 8, 16 or 32 bits, and bits that do not lie in them; for a slope or
// intercept that is not one finite number, a slope of 0; for a modality table beside them, of several items, with other
// than 8 to 16 bits, or with other than the entries that it announces; for padding that is not one number; and if only
// some slices have a slope, an intercept or a table. A slope without an intercept has the intercept 0, an intercept
// without a slope the slope 1.
[[nodiscard]] std::vector<DicomValueRule> valueRulesOf(const DicomSeries& series, const std::string& source);

// Whether some bit outside the stored ones is set, other than by the sign, or by padding of whole words. Words are in
// the machine's byte order.
[[nodiscard]] bool hasOtherBits(const DicomValueRule& rule, std::span<const char> words);

// What a lossy coding put beyond the stored bits becomes the nearest value that they hold. Returns the number of these
// words. Padding of whole words stays. The stored bits are the lowest of a word.
std::size_t clampToStored(const DicomValueRule& rule, std::span<char> words);

// `words` in the machine's byte order, one for each of `densities`. What is too large for a float becomes beyondFloat()
// (engine/field/finite_values.hpp). What was rounded is added to `rounded`. Padding is treated as any other number.
void toDensities(const DicomValueRule& rule, std::span<const char> words, std::span<float> densities,
                 RoundedFew& rounded);

// Sets padding[first + n] for every word n that is padding.
void markPadding(const DicomValueRule& rule, std::span<const char> words, std::vector<bool>& padding,
                 std::size_t first);

}  // namespace palpate
