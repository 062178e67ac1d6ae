// SPDX-License-Identifier: Apache-2.0
#include "engine/files/dicom_values.hpp"

#include <algorithm>
#include <cstring>
#include <map>

#include <fmt/format.h>

#include "base/error.hpp"
#include "engine/field/raw_values.hpp"
#include "engine/files/components.hpp"

namespace palpate {
namespace {

constexpr const char* kCopyAgain = "copy the series again";

void checkGrey(const DicomSlice& slice, const std::string& source) {
  if (slice.file->floating) {
    refuse(source, fmt::format("the pixels of {} are floating-point numbers (FloatPixelData)", slice.name()),
           "convert the series to NIfTI or NRRD");
  }
  const std::uint32_t samples = slice.file->root.number(DicomTag::kSamplesPerPixel, 1);
  if (samples > 1)
    refuseComponents(source, Components::kColours, samples, fmt::format("the pixels of {}", slice.name()));
  const std::string meaning = slice.file->root.text(DicomTag::kPhotometricInterpretation);
  if (meaning.empty() || meaning == "MONOCHROME1" || meaning == "MONOCHROME2") return;
  refuse(source,
         fmt::format("the pixels of {} are {} (PhotometricInterpretation), not grey values", slice.name(), meaning),
         "give a series of MONOCHROME1 or MONOCHROME2");
}

void checkBits(const DicomValueRule& rule, const DicomSlice& slice, const std::string& source) {
  const std::uint32_t allocated = rule.bits_allocated;
  if (allocated != 8 && allocated != 16 && allocated != 32) {
    refuse(source, fmt::format("the pixels of {} take {} bits each (BitsAllocated)", slice.name(), allocated),
           "convert the series to 8, 16 or 32 bits");
  }
  if (rule.bits_stored >= 1 && rule.bits_stored <= rule.high_bit + 1 && rule.high_bit < allocated) return;
  refuse(source,
         fmt::format("in {} no {} bits (BitsStored) with bit {} on top (HighBit) lie in pixels of {} bits "
                     "(BitsAllocated)",
                     slice.name(), rule.bits_stored, rule.high_bit, allocated),
         kCopyAgain);
}

// Empty if the slice has none.
std::optional<double> scaleOf(const DicomSlice& slice, DicomTag tag, const char* name, const std::string& source) {
  const std::string text = slice.text(tag);
  if (text.empty()) return {};
  const std::vector<double> numbers = dicomNumbers(text);
  const bool good = numbers.size() == 1 && std::isfinite(numbers[0]);
  if (good && (numbers[0] != 0 || tag == DicomTag::kRescaleIntercept)) return numbers[0];
  refuse(source, fmt::format("the {} \"{}\" of {} is no number to scale by", name, text, slice.name()), kCopyAgain);
}

void readScale(DicomValueRule& rule, const DicomSlice& slice, const std::string& source) {
  const auto slope = scaleOf(slice, DicomTag::kRescaleSlope, "RescaleSlope", source);
  const auto intercept = scaleOf(slice, DicomTag::kRescaleIntercept, "RescaleIntercept", source);
  rule.has_slope = slope.has_value();
  rule.has_intercept = intercept.has_value();
  rule.slope = slope.value_or(1);
  rule.intercept = intercept.value_or(0);
}

std::int64_t asSigned16(std::uint32_t number) {
  return static_cast<std::int16_t>(number);
}

class ModalityTable {
 public:
  ModalityTable(const DicomSlice& slice, const DicomItem& item, const std::string& source)
      : slice_(slice), item_(item), source_(source) {}

  void read(DicomValueRule& rule) const {
    const DicomElement& descriptor = item_.element(DicomTag::kLutDescriptor);
    if (descriptor.numbers.size() != 3) refuseTable("has no LUTDescriptor of three numbers");
    const std::uint32_t entries = descriptor.numbers[0] == 0 ? 65536 : descriptor.numbers[0];
    rule.first_mapped = rule.is_signed ? asSigned16(descriptor.numbers[1]) : descriptor.numbers[1];
    const bool told_signed = descriptor.type == "SS";
    const bool told = told_signed || descriptor.type == "US";
    if (told && told_signed != rule.is_signed && descriptor.numbers[1] >= 0x8000) {
      refuseTable("begins at a value whose sign contradicts PixelRepresentation");
    }
    const std::uint32_t bits = descriptor.numbers[2];
    if (bits < 8 || bits > 16) refuseTable(fmt::format("has entries of {} bits", bits));
    rule.table = std::make_shared<const std::vector<std::uint16_t>>(entriesOf(entries, bits));
  }

 private:
  [[noreturn]] void refuseTable(const std::string& what) const {
    refuse(source_, fmt::format("the table ModalityLUTSequence of {} {}", slice_.name(), what),
           "convert the series in another program");
  }

  // Entries of 8 bits may lie in a byte or in a word each; the length tells (PS3.3, C.11.1.1.1).
  [[nodiscard]] std::vector<std::uint16_t> entriesOf(std::size_t count, std::uint32_t bits) const {
    const std::string& bytes = item_.element(DicomTag::kLutData).bytes;
    std::vector<std::uint16_t> entries(count);
    if (bytes.size() == 2 * count) {
      std::memcpy(entries.data(), bytes.data(), bytes.size());
      if (slice_.file->swapped) swapBytes({reinterpret_cast<char*>(entries.data()), bytes.size()}, ValueType::kUint16);
      return entries;
    }
    if (bits != 8 || bytes.size() != count + count % 2) {
      refuseTable(fmt::format("has {} bytes for {} entries of {} bits", bytes.size(), count, bits));
    }
    if (slice_.file->swapped) refuseTable("has two entries in a word, in big-endian order");
    std::transform(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(count), entries.begin(),
                   [](char entry) { return static_cast<unsigned char>(entry); });
    return entries;
  }

  const DicomSlice& slice_;
  const DicomItem& item_;
  const std::string& source_;
};

void readTable(DicomValueRule& rule, const DicomSlice& slice, const std::string& source) {
  const auto& items = slice.file->root.element(DicomTag::kModalityLutSequence).items;
  if (items.empty()) return;
  if (items.size() > 1) {
    refuse(source, fmt::format("{} has {} tables in ModalityLUTSequence", slice.name(), items.size()),
           "convert the series in another program");
  }
  if (rule.has_slope || rule.has_intercept) {
    refuse(source,
           fmt::format("{} has a {} and a ModalityLUTSequence, which exclude each other", slice.name(),
                       rule.has_slope ? "RescaleSlope" : "RescaleIntercept"),
           "convert the series in another program");
  }
  ModalityTable(slice, items[0], source).read(rule);
}

// The type of these numbers, US or SS, is often wrong, and PixelRepresentation says what is meant.
std::optional<std::int64_t> paddingNumber(const DicomSlice& slice, DicomTag tag, const char* name, bool is_signed,
                                          const std::string& source) {
  if (!slice.file->root.has(tag)) return {};
  const std::vector<std::uint32_t>& numbers = slice.file->root.element(tag).numbers;
  if (numbers.size() != 1)
    refuse(source, fmt::format("the {} of {} is not one number of 16 bits", name, slice.name()), kCopyAgain);
  return is_signed ? asSigned16(numbers[0]) : numbers[0];
}

// The stored value of a word.
class Stored {
 public:
  explicit Stored(const DicomValueRule& rule)
      : shift_(rule.high_bit + 1 - rule.bits_stored),
        mask_((std::int64_t{1} << rule.bits_stored) - 1),
        sign_(rule.is_signed ? std::int64_t{1} << (rule.bits_stored - 1) : 0) {}
  // Of the whole word, as if all its bits were stored.
  static Stored wholeWord(DicomValueRule rule) {
    rule.bits_stored = rule.bits_allocated;
    rule.high_bit = rule.bits_allocated - 1;
    return Stored(rule);
  }

  [[nodiscard]] std::int64_t of(std::uint32_t word) const {
    const std::int64_t value = (std::int64_t{word} >> shift_) & mask_;
    return (value ^ sign_) - sign_;  // a set sign bit stands for minus its place
  }
  [[nodiscard]] std::int64_t lowest() const { return -sign_; }
  [[nodiscard]] std::int64_t highest() const { return mask_ - sign_; }

 private:
  std::uint32_t shift_;
  std::int64_t mask_, sign_;
};

// A number that the stored bits cannot hold, such as -2000 in 12 bits, was written into whole words.
void readPadding(DicomValueRule& rule, const DicomSlice& slice, const std::string& source) {
  const auto value = paddingNumber(slice, DicomTag::kPixelPaddingValue, "PixelPaddingValue", rule.is_signed, source);
  const auto limit =
      paddingNumber(slice, DicomTag::kPixelPaddingRangeLimit, "PixelPaddingRangeLimit", rule.is_signed, source);
  if (limit && !value) {
    refuse(source, fmt::format("{} has a PixelPaddingRangeLimit and no PixelPaddingValue", slice.name()), kCopyAgain);
  }
  if (!value) return;
  rule.padding = {std::min(*value, limit.value_or(*value)), std::max(*value, limit.value_or(*value))};
  const Stored stored(rule);
  rule.padding_is_word = rule.padding->lowest < stored.lowest() || rule.padding->highest > stored.highest();
}

// Calls `work(n, word)` for every word.
template <class Work>
void forEachWord(const DicomValueRule& rule, std::span<const char> words, const Work& work) {
  const auto each = [&](auto word) {
    for (std::size_t n = 0; n < words.size() / sizeof word; ++n) {
      std::memcpy(&word, words.data() + n * sizeof word, sizeof word);
      work(n, std::uint32_t{word});
    }
  };
  if (rule.bits_allocated == 8) return each(std::uint8_t{});
  if (rule.bits_allocated == 16) return each(std::uint16_t{});
  each(std::uint32_t{});
}

// All but the table, which all frames of a file share.
DicomValueRule ruleOfFrame(const DicomSlice& slice, const std::string& source) {
  checkGrey(slice, source);
  const DicomItem& root = slice.file->root;
  DicomValueRule rule;
  rule.bits_allocated = root.number(DicomTag::kBitsAllocated, 0);
  rule.bits_stored = root.number(DicomTag::kBitsStored, rule.bits_allocated);
  rule.high_bit = root.number(DicomTag::kHighBit, rule.bits_stored - 1);
  const std::uint32_t representation = root.number(DicomTag::kPixelRepresentation, 0);
  if (representation > 1)
    refuse(source, fmt::format("the PixelRepresentation {} of {} is not 0 or 1", representation, slice.name()),
           kCopyAgain);
  rule.is_signed = representation == 1;
  checkBits(rule, slice, source);
  readScale(rule, slice, source);
  readPadding(rule, slice, source);
  return rule;
}

// Whether the stored value alone makes this word: with its sign in the bits above, or with zeros there.
bool isOwnWord(const DicomValueRule& rule, const Stored& stored, std::uint32_t word) {
  const std::uint32_t whole = static_cast<std::uint32_t>((std::uint64_t{1} << rule.bits_allocated) - 1);
  const std::uint32_t low = rule.high_bit + 1 - rule.bits_stored;
  const auto extended = static_cast<std::uint32_t>(stored.of(word)) << low & whole;
  const std::uint32_t cleared = extended & static_cast<std::uint32_t>((std::uint64_t{1} << (rule.high_bit + 1)) - 1);
  return word == extended || word == cleared;
}

// Whether padding that the stored bits do not hold made this word.
bool isPaddingWord(const DicomValueRule& rule, const Stored& whole, std::uint32_t word) {
  if (!rule.padding || !rule.padding_is_word) return false;
  const std::int64_t value = whole.of(word);
  return value >= rule.padding->lowest && value <= rule.padding->highest;
}

}  // namespace

std::vector<DicomValueRule> valueRulesOf(const DicomSeries& series, const std::string& source) {
  std::vector<DicomValueRule> rules;
  const auto check = [&](const DicomSlice& slice, bool here, bool first, const char* what) {
    if (here == first) return;
    refuse(source,
           fmt::format("{} has a {}, and {} has none", (here ? slice : series[0]).name(), what,
                       (here ? series[0] : slice).name()),
           "keep one scan in a folder");
  };
  std::map<const DicomDataSet*, DicomValueRule> of_file;
  for (const DicomSlice& slice : series) {
    rules.push_back(ruleOfFrame(slice, source));
    DicomValueRule& rule = rules.back();
    const auto [first, is_new] = of_file.try_emplace(slice.file.get(), rule);
    if (is_new) readTable(first->second, slice, source);
    rule.table = first->second.table;
    rule.first_mapped = first->second.first_mapped;
    check(slice, rule.has_slope, rules[0].has_slope, "RescaleSlope");
    check(slice, rule.has_intercept, rules[0].has_intercept, "RescaleIntercept");
    check(slice, rule.table != nullptr, rules[0].table != nullptr, "ModalityLUTSequence");
  }
  return rules;
}

bool hasOtherBits(const DicomValueRule& rule, std::span<const char> words) {
  const Stored stored(rule);
  const Stored whole = Stored::wholeWord(rule);
  bool other = false;
  forEachWord(rule, words, [&](std::size_t, std::uint32_t word) {
    other = other || (!isOwnWord(rule, stored, word) && !isPaddingWord(rule, whole, word));
  });
  return other;
}

// Signed words come with their sign in all bits above, or with zeros there. Words of the latter kind that the stored
// bits do not hold cannot be told from negative ones, so a frame without negative words is left as it is up to the
// mask.
std::size_t clampToStored(const DicomValueRule& rule, std::span<char> words) {
  const Stored stored(rule);
  const Stored whole = Stored::wholeWord(rule);
  bool extended = !rule.is_signed;
  forEachWord(rule, words, [&](std::size_t, std::uint32_t word) { extended = extended || whole.of(word) < 0; });
  std::size_t clamped = 0;
  forEachWord(rule, words, [&](std::size_t n, std::uint32_t word) {
    if ((!extended && isOwnWord(rule, stored, word)) || isPaddingWord(rule, whole, word)) return;
    const std::int64_t value = whole.of(word);
    const std::int64_t within = std::clamp(value, stored.lowest(), stored.highest());
    if (value == within) return;
    const auto bits = static_cast<std::uint64_t>(within);
    for (std::size_t byte = 0; byte < rule.wordBytes(); ++byte) {
      const std::size_t place = std::endian::native == std::endian::little ? byte : rule.wordBytes() - 1 - byte;
      words[n * rule.wordBytes() + place] = static_cast<char>(bits >> 8U * byte & 0xffU);
    }
    ++clamped;
  });
  return clamped;
}

void toDensities(const DicomValueRule& rule, std::span<const char> words, std::span<float> densities,
                 RoundedFew& rounded) {
  const Stored stored(rule);
  const auto last = rule.table ? static_cast<std::int64_t>(rule.table->size()) - 1 : 0;
  forEachWord(rule, words, [&](std::size_t n, std::uint32_t word) {
    const std::int64_t value = stored.of(word);
    if (rule.table) {
      densities[n] =
          (*rule.table)[static_cast<std::size_t>(std::clamp<std::int64_t>(value - rule.first_mapped, 0, last))];
      return;
    }
    const double exact = static_cast<double>(value) * rule.slope + rule.intercept;
    densities[n] = floatOf(exact);
    rounded.add(exact, densities[n]);
  });
}

void markPadding(const DicomValueRule& rule, std::span<const char> words, std::vector<bool>& padding,
                 std::size_t first) {
  if (!rule.padding) return;
  const Stored stored = rule.padding_is_word ? Stored::wholeWord(rule) : Stored(rule);
  forEachWord(rule, words, [&](std::size_t n, std::uint32_t word) {
    const std::int64_t value = stored.of(word);
    if (value >= rule.padding->lowest && value <= rule.padding->highest) padding[first + n] = true;
  });
}

}  // namespace palpate
