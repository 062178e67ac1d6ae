// SPDX-License-Identifier: Apache-2.0
// What the words of DICOM images mean, worked out by hand from PS3.5, 8.1.1, and PS3.3, C.7.5.1.1.2 and C.11.1.
#include "engine/files/dicom_values.hpp"

#include <functional>

#include <fmt/format.h>

#include "engine/field/finite_values.hpp"
#include "tests/engine/files/dicom_writer.hpp"
#include "tests/engine/files/packed_dicom.hpp"

namespace palpate {
namespace dicom_values_test {

template <class Word>
std::vector<float> densitiesOf(const DicomValueRule& rule, const std::vector<Word>& words,
                               RoundedFew* rounded = nullptr) {
  std::vector<float> densities(words.size());
  RoundedFew few;
  toDensities(rule, {reinterpret_cast<const char*>(words.data()), words.size() * sizeof(Word)}, densities, few);
  if (rounded != nullptr) *rounded = few;
  return densities;
}
using Floats = std::vector<float>;
using Bytes = std::vector<std::uint8_t>;
using Shorts = std::vector<std::uint16_t>;
using Longs = std::vector<std::uint32_t>;

DicomValueRule bits(std::uint32_t allocated, std::uint32_t stored, std::uint32_t high, bool is_signed) {
  DicomValueRule rule;
  rule.bits_allocated = allocated;
  rule.bits_stored = stored;
  rule.high_bit = high;
  rule.is_signed = is_signed;
  return rule;
}

TEST(DicomValues, LieInTheBitsBelowTheHighBit) {
  // Twelve bits at the bottom, in the middle, on top; the others are set and mean nothing.
  EXPECT_EQ(densitiesOf(bits(16, 12, 11, false), Shorts{0xf000, 0xf001, 0xffff, 0x0800}), (Floats{0, 1, 4095, 2048}));
  EXPECT_EQ(densitiesOf(bits(16, 12, 13, false), Shorts{0xc003, 0xc007, 0xffff, 0x2000}), (Floats{0, 1, 4095, 2048}));
  EXPECT_EQ(densitiesOf(bits(16, 12, 15, false), Shorts{0x000f, 0x001f, 0xffff, 0x8000}), (Floats{0, 1, 4095, 2048}));
  // The highest stored bit is the sign.
  EXPECT_EQ(densitiesOf(bits(16, 12, 11, true), Shorts{0xf7ff, 0x0800, 0x0fff, 0xf000}), (Floats{2047, -2048, -1, 0}));
  EXPECT_EQ(densitiesOf(bits(16, 12, 15, true), Shorts{0x7fff, 0x8000, 0xfff0, 0x000f}), (Floats{2047, -2048, -1, 0}));
  EXPECT_EQ(densitiesOf(bits(16, 16, 15, true), Shorts{0x7fff, 0x8000, 0xffff}), (Floats{32767, -32768, -1}));
  EXPECT_EQ(densitiesOf(bits(8, 8, 7, false), Bytes{0, 127, 128, 255}), (Floats{0, 127, 128, 255}));
  EXPECT_EQ(densitiesOf(bits(8, 8, 7, true), Bytes{0, 127, 128, 255}), (Floats{0, 127, -128, -1}));
  EXPECT_EQ(densitiesOf(bits(8, 1, 0, false), Bytes{0xfe, 0xff}), (Floats{0, 1}));
  EXPECT_EQ(densitiesOf(bits(8, 1, 0, true), Bytes{0xfe, 0xff}), (Floats{0, -1}));
  EXPECT_EQ(densitiesOf(bits(32, 32, 31, false), Longs{0, 0xffffffff}), (Floats{0, 4294967296.0F}));
  EXPECT_EQ(densitiesOf(bits(32, 32, 31, true), Longs{0x80000000, 0xffffffff}), (Floats{-2147483648.0F, -1}));
  EXPECT_EQ(densitiesOf(bits(32, 20, 24, true), Longs{0x00ffffe0, 0x01000000}), (Floats{524287, -524288}));
}

TEST(DicomValues, AreScaledInDoubleAndRoundedOnce) {
  DicomValueRule rule = bits(16, 16, 15, true);
  rule.slope = -2.5;
  rule.intercept = 1024;
  EXPECT_EQ(densitiesOf(rule, Shorts{0, 1, 0xffff}), (Floats{1024, 1021.5F, 1026.5F}));
  // 2^24 + 1 is no float, but 2^24 + 1 - 2^24 is: the sum is rounded, not its parts.
  rule = bits(32, 32, 31, false);
  rule.intercept = -16777216;
  EXPECT_EQ(densitiesOf(rule, Longs{16777217}), Floats{1});
  rule.slope = 1e38;
  const Floats beyond = densitiesOf(rule, Longs{3, 4});
  EXPECT_TRUE(std::isfinite(beyond[0]));
  EXPECT_EQ(std::bit_cast<std::uint32_t>(beyond[1]), kBeyondFloatBits);
}

// What no float reaches is told otherwise. 2^24 + 1 becomes 2^24, 2^32 - 1 becomes 2^32, and 2^24 + 3 becomes 2^24 + 4:
// whether padding keeps its density is settled later.
TEST(DicomValues, ThatNoFloatHoldsAreCounted) {
  DicomValueRule rule = bits(32, 32, 31, false);
  rule.padding = {16777219, 16777219};
  RoundedFew rounded;
  const Longs words = {16777216, 16777217, 16777219, 0xffffffff, 3};
  static_cast<void>(densitiesOf(rule, words, &rounded));
  EXPECT_EQ(rounded.count, 3U);
  EXPECT_EQ(rounded.most, 1);
  rule.slope = 1e38;  // of 3e38 alone, whose float is another double
  static_cast<void>(densitiesOf(rule, words, &rounded));
  EXPECT_EQ(rounded.count, 1U);
  EXPECT_EQ(rounded.most, std::abs(3e38 - static_cast<double>(3e38F)));
  rule = bits(16, 16, 15, true);
  rule.table = std::make_shared<const Shorts>(Shorts{10, 20, 65535});
  static_cast<void>(densitiesOf(rule, Shorts{0, 1, 2}, &rounded));
  EXPECT_EQ(rounded.count, 0U);
}

TEST(DicomValues, ComeFromTheTableWhereThereIsOne) {
  DicomValueRule rule = bits(16, 16, 15, true);
  rule.table = std::make_shared<const Shorts>(Shorts{10, 20, 40, 65535});
  rule.first_mapped = -1;
  // What lies below the first entry's value has the first entry, what lies above the last the last.
  EXPECT_EQ(densitiesOf(rule, Shorts{0x8000, 0xfffe, 0xffff, 0, 1, 2, 3, 0x7fff}),
            (Floats{10, 10, 10, 20, 40, 65535, 65535, 65535}));
}

TEST(DicomValues, OfPaddingAreMarkedAndHaveTheirDensities) {
  DicomValueRule rule = bits(16, 12, 11, true);
  rule.padding = {-2048, -2046};
  rule.slope = 2;
  const Shorts words = {0x0800, 0x0802, 0x0803, 0x07ff};
  EXPECT_EQ(densitiesOf(rule, words), (Floats{-4096, -4092, -4090, 4094}));
  const auto marked = [&] {
    std::vector<bool> padding(6);
    markPadding(rule, {reinterpret_cast<const char*>(words.data()), 2 * words.size()}, padding, 1);
    return padding;
  };
  EXPECT_EQ(marked(), (std::vector<bool>{false, true, true, false, false, false}));
  // Of whole words: these are 0x0800 to 0x0802.
  rule.padding = {0x0801, 0x0803};
  rule.padding_is_word = true;
  EXPECT_EQ(marked(), (std::vector<bool>{false, false, true, true, false, false}));
  rule.padding.reset();
  EXPECT_EQ(marked(), std::vector<bool>(6));
}

// Lossy codings overshoot: 4096 of 12 bits is 4095, and 2050 of signed ones, or -2050, are 2047 and -2048.
TEST(DicomValues, BeyondTheStoredBitsAreClampedAndCounted) {
  const auto clamped = [](const DicomValueRule& rule, auto words) {
    const std::size_t count =
        clampToStored(rule, {reinterpret_cast<char*>(words.data()), words.size() * sizeof words[0]});
    return std::pair(count, words);
  };
  EXPECT_EQ(clamped(bits(16, 12, 11, false), Shorts{0, 4095, 4096, 65535}),
            std::pair(std::size_t{2}, Shorts{0, 4095, 4095, 4095}));
  EXPECT_EQ(clamped(bits(16, 12, 11, true), Shorts{0xffff, 0x07ff, 0x0802, 0xf7fe, 0xf800, 0x7fff}),
            std::pair(std::size_t{3}, Shorts{0xffff, 0x07ff, 0x07ff, 0xf800, 0xf800, 0x07ff}));
  // Zeros above the sign of every word: 0x0802 then is -2046. 0x1000 is nothing that twelve bits hold.
  EXPECT_EQ(clamped(bits(16, 12, 11, true), Shorts{0x0fff, 0x0802, 0, 0x1000}),
            std::pair(std::size_t{1}, Shorts{0x0fff, 0x0802, 0, 0x07ff}));
  EXPECT_EQ(clamped(bits(16, 16, 15, true), Shorts{0xffff, 0x8000}), std::pair(std::size_t{0}, Shorts{0xffff, 0x8000}));
  EXPECT_EQ(clamped(bits(8, 5, 4, false), Bytes{31, 32, 255}), std::pair(std::size_t{2}, Bytes{31, 31, 31}));
  EXPECT_EQ(clamped(bits(32, 20, 19, true), Longs{0xffffffff, 0x00100000, 0x80000000}),
            std::pair(std::size_t{2}, Longs{0xffffffff, 0x0007ffff, 0xfff80000}));
}

TEST(DicomValues, KnowsBitsThatAreNoSign) {
  const auto others = [](const DicomValueRule& rule, const Shorts& words) {
    return hasOtherBits(rule, {reinterpret_cast<const char*>(words.data()), 2 * words.size()});
  };
  EXPECT_FALSE(others(bits(16, 12, 11, true), {0x0fff, 0xffff, 0x07ff, 0}));
  EXPECT_TRUE(others(bits(16, 12, 11, true), {0x17ff}));
  EXPECT_TRUE(others(bits(16, 12, 11, true), {0, 0xf7ff}));
  EXPECT_FALSE(others(bits(16, 12, 11, false), {0x0fff, 0}));
  EXPECT_TRUE(others(bits(16, 12, 11, false), {0x1000}));
  EXPECT_FALSE(others(bits(16, 16, 15, true), {0xffff, 0x8000}));
}

// --- of whole series ------------------------------------------------------------------------------------------------

class DicomValuesOfSeries : public testing::Test {
 protected:
  using Change = std::function<void(WrittenItem&)>;
  // Two slices of these six words each, and what `change` makes of the second or of both.
  void write(const WrittenImage& image, const Change& change = {}, bool both = true,
             const std::string& syntax = kLittleEndianDicom) const {
    for (int n = 0; n < 2; ++n) {
      WrittenItem set = imageSet(image);
      placeAt(set, fmt::format("0\\0\\{}", 2 * n));
      if (change && (both || n == 1)) change(set);
      writeFile(folder_.file(fmt::format("s{}.dcm", n)), DicomWriter(syntax).file(set));
    }
  }
  void expectSlices(const Floats& slice, const std::string& more = "") const {
    Floats both = slice;
    both.insert(both.end(), slice.begin(), slice.end());
    EXPECT_EQ(loadVolume(folder_.path() + more).toDense(), both);
  }
  void refuses(const std::string& reason) const { expectLoadRefusal(folder_.path(), reason); }

  static WrittenImage ramp() {
    WrittenImage image;
    image.words = {0, 1, 2, -1, 100, 32767};
    return image;
  }
  static Change scale(const std::string& slope, const std::string& intercept) {
    return [=](WrittenItem& set) {
      if (!intercept.empty()) set[0x00281052] = textOf("DS", intercept);
      if (!slope.empty()) set[0x00281053] = textOf("DS", slope);
    };
  }
  static WrittenElement table(const std::vector<std::int64_t>& descriptor, const WrittenElement& data,
                              const std::string& type = "SS") {
    return itemsOf({{{0x00283002, numbersOf(type, descriptor)}, {0x00283006, data}}});
  }

  TempFolder folder_;
};

// White where values are low: that is how it is shown, and says nothing of what was measured.
TEST_F(DicomValuesOfSeries, AreTheSameHoweverTheyAreShown) {
  for (const char* meaning : {"MONOCHROME1", "MONOCHROME2"}) {
    WrittenImage image = ramp();
    image.meaning = meaning;
    write(image, scale("2", "-100"));
    expectSlices({-100, -98, -96, -102, 100, 65434});
  }
}

TEST_F(DicomValuesOfSeries, LieInTheBitsThatTheFileNames) {
  WrittenImage image;
  image.bits_stored = 12;
  image.high_bit = 13;
  image.words = {0x0004, 0xc003, 0x1ffc, 0x2000, 0x3ffc, 0xffff};
  for (const char* syntax : {kLittleEndianDicom, kBigEndianDicom, kImplicitDicom, kDeflatedDicom}) {
    write(image, {}, true, syntax);
    expectSlices({1, 0, 2047, -2048, -1, -1});
  }
}

TEST_F(DicomValuesOfSeries, AreRefusedInBitsThatDoNotFit) {
  for (const auto& [allocated, stored, high] : {std::array{16, 0, 15}, {16, 17, 16}, {16, 12, 10}, {16, 12, 16}}) {
    WrittenImage image = ramp();
    image.bits_stored = stored;
    image.high_bit = high;
    write(image);
    refuses(fmt::format("in slice s0.dcm no {} bits (BitsStored) with bit {} on top (HighBit)", stored, high));
  }
  for (const int allocated : {1, 12, 24, 64}) {
    write(ramp(), [&](WrittenItem& set) {
      set[0x00280100] = numbersOf("US", {allocated});
      set[0x7fe00010] = numbersOf("OW", std::vector<std::int64_t>(24));
    });
    refuses(fmt::format("take {} bits each (BitsAllocated)", allocated));
  }
  write(ramp(), [](WrittenItem& set) { set[0x00280103] = numbersOf("US", {2}); });
  refuses("the PixelRepresentation 2 of slice s0.dcm");
}

TEST_F(DicomValuesOfSeries, AreRefusedIfTheyAreNoGreyValues) {
  for (const char* meaning : {"PALETTE COLOR", "RGB", "YBR_FULL"}) {
    WrittenImage image = ramp();
    image.meaning = meaning;
    write(image);
    refuses(fmt::format("the pixels of slice s0.dcm are {} (PhotometricInterpretation)", meaning));
  }
  for (const std::uint32_t tag : {0x7fe00008U, 0x7fe00009U}) {
    write(ramp(), [&](WrittenItem& set) {
      set.erase(0x7fe00010);
      set[tag] = numbersOf("OW", std::vector<std::int64_t>(24));
    });
    refuses("floating-point numbers (FloatPixelData)");
  }
}

TEST_F(DicomValuesOfSeries, AreRefusedWhereOnlySomeSlicesAreScaled) {
  write(ramp(), scale("2", "0"), false);
  refuses("slice s1.dcm has a RescaleSlope, and slice s0.dcm has none; keep one scan in a folder");
  write(ramp(), scale("", "2"), false);
  refuses("slice s1.dcm has a RescaleIntercept, and slice s0.dcm has none; keep one scan in a folder");
  // Both have a slope, one an intercept too.
  write(ramp(), scale("2", ""));
  WrittenItem other = imageSet(ramp());
  placeAt(other, "0\\0\\2");
  scale("2", "5")(other);
  writeFile(folder_.file("s1.dcm"), DicomWriter(kLittleEndianDicom).file(other));
  refuses("slice s1.dcm has a RescaleIntercept, and slice s0.dcm has none");
  write(
      ramp(),
      [](WrittenItem& set) {
        set[0x00283000] = table({2, 0, 16}, numbersOf("OW", {5, 6}));
      },
      false);
  refuses("slice s1.dcm has a ModalityLUTSequence, and slice s0.dcm has none");
}

// Some programs leave out an intercept of 0 or a slope of 1, or write nothing into it.
TEST_F(DicomValuesOfSeries, AreScaledByWhatTheFilesHaveOfSlopeAndIntercept) {
  const auto remark = [&] { return loadVolume(folder_.path()).facts().remark; };
  write(ramp(), scale("2", ""));
  expectSlices({0, 2, 4, -2, 200, 65534});
  EXPECT_EQ(remark(), "its files have a RescaleSlope and no RescaleIntercept, which is taken as 0");
  write(ramp(), scale("2", " "));
  expectSlices({0, 2, 4, -2, 200, 65534});
  write(ramp(), scale("", "-5"));
  expectSlices({-5, -4, -3, -6, 95, 32762});
  EXPECT_EQ(remark(), "its files have a RescaleIntercept and no RescaleSlope, which is taken as 1");
  write(ramp(), scale("2", "-5"));
  EXPECT_EQ(remark(), "");
  write(ramp());
  EXPECT_EQ(remark(), "");
}

// The scale of a file counts whatever made it.
TEST_F(DicomValuesOfSeries, OfMrAreScaledAsThoseOfCt) {
  write(ramp(), [](WrittenItem& set) {
    set[0x00080016] = textOf("UI", "1.2.840.10008.5.1.4.1.1.4");
    set[0x00080060] = textOf("CS", "MR");
    scale("0.5", "-3")(set);
  });
  expectSlices({-3, -2.5F, -2, -3.5F, 47, 16380.5F});
}

TEST_F(DicomValuesOfSeries, ComeFromTheTableOfTheFile) {
  for (const char* syntax : {kLittleEndianDicom, kBigEndianDicom, kImplicitDicom, kDeflatedDicom}) {
    SCOPED_TRACE(syntax);
    for (const char* type : {"OW", "US"}) {
      write(
          ramp(),
          [&](WrittenItem& set) {
            set[0x00283000] = table({3, -1, 16}, numbersOf(type, {7, 60000, 9}));
          },
          true, syntax);
      expectSlices({60000, 9, 9, 7, 9, 9});
    }
    // Entries of 8 bits, one in each word.
    write(
        ramp(),
        [&](WrittenItem& set) {
          set[0x00283000] = table({3, 0, 8}, numbersOf("OW", {7, 200, 9}));
        },
        true, syntax);
    expectSlices({7, 200, 9, 7, 9, 9});
  }
  EXPECT_EQ(loadVolume(folder_.path()).facts().rescale_in_words,
            "what the table ModalityLUTSequence gives for the stored value");
  // The same, two in a word, of an even and of an odd number.
  for (const std::size_t count : {3U, 4U}) {
    const std::string entries = std::string("\x07\xc8\x09\x05").substr(0, count);
    const auto change = [&](WrittenItem& set) {
      set[0x00283000] = table({static_cast<std::int64_t>(count), 0, 8}, textOf("OB", entries));
    };
    write(ramp(), change);
    expectSlices({7, 200, 9, 7, count == 3 ? 9.0F : 5.0F, count == 3 ? 9.0F : 5.0F});
    write(ramp(), change, true, kBigEndianDicom);
    refuses("has two entries in a word, in big-endian order");
  }
  // 0 entries stand for 65536, and the first value of an unsigned image has no sign.
  WrittenImage image = ramp();
  image.is_signed = false;
  std::vector<std::int64_t> all(65536);
  for (std::size_t n = 0; n < all.size(); ++n) all[n] = static_cast<std::int64_t>(65535 - n);
  const auto whole = [&](std::int64_t first) {
    return [&all, first](WrittenItem& set) { set[0x00283000] = table({0, first, 16}, numbersOf("OW", all), "US"); };
  };
  write(image, whole(0));
  expectSlices({65535, 65534, 65533, 0, 65435, 32768});
  write(image, whole(65535));
  expectSlices({65535, 65535, 65535, 65535, 65535, 65535});
}

TEST_F(DicomValuesOfSeries, AreRefusedWithATableThatIsNotClear) {
  const auto with = [&](const WrittenElement& sequence, const std::string& reason) {
    write(ramp(), [&](WrittenItem& set) { set[0x00283000] = sequence; });
    refuses("ModalityLUTSequence of slice s0.dcm " + reason);
  };
  with(table({3, 0}, numbersOf("OW", {1, 2, 3})), "has no LUTDescriptor of three numbers");
  with(table({3, 0, 7}, numbersOf("OW", {1, 2, 3})), "has entries of 7 bits");
  with(table({3, 0, 17}, numbersOf("OW", {1, 2, 3})), "has entries of 17 bits");
  with(table({4, 0, 16}, numbersOf("OW", {1, 2, 3})), "has 6 bytes for 4 entries of 16 bits");
  with(table({2, 0, 16}, numbersOf("OW", {1, 2, 3})), "has 6 bytes for 2 entries of 16 bits");
  with(table({2, 40000, 16}, numbersOf("OW", {1, 2}), "US"), "begins at a value whose sign contradicts");
  const WrittenElement one = table({2, 0, 16}, numbersOf("OW", {1, 2}));
  write(ramp(), [&](WrittenItem& set) { set[0x00283000] = itemsOf({one.items[0], one.items[0]}); });
  refuses("slice s0.dcm has 2 tables in ModalityLUTSequence");
  write(ramp(), [&](WrittenItem& set) {
    scale("2", "1")(set);
    set[0x00283000] = one;
  });
  refuses("a RescaleSlope and a ModalityLUTSequence, which exclude each other");
  write(ramp(), [&](WrittenItem& set) {
    scale("", "1")(set);
    set[0x00283000] = one;
  });
  refuses("a RescaleIntercept and a ModalityLUTSequence, which exclude each other");
}

// In each of two slices a tenth of 1, 2, -1 and 32767; of 0 and 100 it is whole.
TEST_F(DicomValuesOfSeries, ThatNoFloatHoldsAreTold) {
  write(ramp(), scale("0.1", "0"));
  const Rounding& rounded = loadVolume(folder_.path()).facts().rounded;
  EXPECT_EQ(rounded.count, 2U * 4);
  EXPECT_EQ(rounded.of, "scaled int16");
  write(ramp(), scale("0.5", "-100"));
  EXPECT_EQ(loadVolume(folder_.path()).facts().rounded.count, 0U);
}

// --- padding --------------------------------------------------------------------------------------------------------

TEST_F(DicomValuesOfSeries, OfPaddingAreTheLowestDensityOrWhatTheUserSays) {
  const auto padded = [&](WrittenItem& set) {
    scale("2", "-100")(set);
    set[0x00280120] = numbersOf("SS", {2});
  };
  write(ramp(), padded);
  expectSlices({-100, -98, -102, -102, 100, 65434});  // -102: of the stored -1
  EXPECT_EQ(loadVolume(folder_.path()).facts().remark,
            "2 of 12 pixels are padding in the files; 2 of 12 voxels have no value and are -102 here, the lowest "
            "density (--nan gives another)");
  expectSlices({-100, -98, -7, -102, 100, 65434}, "?nan=-7");
  EXPECT_EQ(loadVolume(folder_.path() + "?nan=-7").facts().remark,
            "2 of 12 pixels are padding in the files; 2 of 12 voxels have no value and are -7 here");
  EXPECT_EQ(loadVolume(folder_.path()).facts().replaced, 2U);
  EXPECT_EQ(loadVolume(folder_.path() + "?nan=-7").facts().replaced, 2U);
  // A range, its ends in any order; the type US where SS is meant is a common mistake.
  for (const auto& [value, limit] : {std::pair{-1, 1}, {1, -1}}) {
    for (const char* type : {"SS", "US"}) {
      write(ramp(), [&](WrittenItem& set) {
        set[0x00280120] = numbersOf(type, {value});
        set[0x00280121] = numbersOf(type, {limit});
      });
      expectSlices({-7, -7, 2, -7, 100, 32767}, "?nan=-7");
    }
  }
  // Of no pixel: nothing is said.
  write(ramp(), [](WrittenItem& set) { set[0x00280120] = numbersOf("SS", {-2000}); });
  expectSlices({0, 1, 2, -1, 100, 32767});
  EXPECT_EQ(loadVolume(folder_.path()).facts().remark.find("padding"), std::string::npos);
}

// What a scanner marks lies below all that it measures, and the background of a mask or a map of labels is 0.
TEST_F(DicomValuesOfSeries, OfPaddingStayWhereNothingIsBelow) {
  write(ramp(), [](WrittenItem& set) { set[0x00280120] = numbersOf("SS", {-1}); });
  expectSlices({0, 1, 2, -1, 100, 32767});
  EXPECT_EQ(loadVolume(folder_.path()).facts().remark,
            "2 of 12 pixels are padding in the files and keep their densities (--nan gives another)");
  expectSlices({0, 1, 2, -7, 100, 32767}, "?nan=-7");
  // As low as the lowest: here by a slope that turns the order over.
  write(ramp(), [](WrittenItem& set) {
    scale("-1", "0")(set);
    set[0x00280120] = numbersOf("SS", {32767});
  });
  expectSlices({0, -1, -2, 1, -100, -32767});
  for (const std::vector<std::int64_t>& words :
       {std::vector<std::int64_t>{0, 0, 1, 1, 0, 0}, {0, 0, 1, 2, 3, 0}, {0, 0, 0, 0, 0, 7}}) {
    WrittenImage mask;
    mask.words = words;
    write(mask, [](WrittenItem& set) { set[0x00280120] = numbersOf("SS", {0}); });
    expectSlices(Floats(words.begin(), words.end()));
  }
}

// Of a picture: within its span below it is kept, as -2000 beside a CT is, and -32768 is not.
TEST_F(DicomValuesOfSeries, OfPaddingFarBelowAPictureAreReplaced) {
  for (const std::int64_t padding : {-400, -401, -32768}) {
    WrittenImage image;
    image.words = {padding, 0, 100, 400, 300, padding};
    write(image, [&](WrittenItem& set) { set[0x00280120] = numbersOf("SS", {padding}); });
    const float instead = padding == -400 ? -400 : 0;
    expectSlices({instead, 0, 100, 400, 300, instead});
  }
}

// A mask of which the inside is padding would hold one density if padding became another.
TEST_F(DicomValuesOfSeries, OfPaddingStayWhereAllElseHasOneDensity) {
  WrittenImage mask;
  mask.words = {0, 0, 1, 1, 0, 0};
  const auto inside = [](WrittenItem& set) { set[0x00280120] = numbersOf("SS", {1}); };
  write(mask, inside);
  expectSlices({0, 0, 1, 1, 0, 0});
  expectSlices({0, 0, 5, 5, 0, 0}, "?nan=5");
  mask.words = {1, 1, 1, 1, 1, 0};  // all but one pixel of a slice
  write(mask, inside);
  expectSlices({1, 1, 1, 1, 1, 0});
  mask.words = {0, 0, 1, 1, 2, 0};  // two other densities: the volume is none of one
  write(mask, inside);
  expectSlices({0, 0, 0, 0, 2, 0});
}

// A range of padding, of which a part lies at or below the lowest of all else, -1, and a part above.
TEST_F(DicomValuesOfSeries, OfPaddingStayOneByOne) {
  WrittenImage image;
  image.words = {-5, 2, -1, 4, 1, 6};
  const auto range = [](std::int64_t lowest, std::int64_t highest) {
    return [=](WrittenItem& set) {
      set[0x00280120] = numbersOf("SS", {lowest});
      set[0x00280121] = numbersOf("SS", {highest});
    };
  };
  write(image, range(-5, 2));  // all else: 4 and 6
  expectSlices({-5, 2, -1, 4, 1, 6});
  write(image, range(1, 2));  // the lowest else: -5
  expectSlices({-5, -5, -1, 4, -5, 6});
  image.words = {-5, 2, 3, 4, 1, 6};
  write(image, [&](WrittenItem& set) {
    range(1, 4)(set);
    scale("-1", "0")(set);  // padding -2, -3, -4, -1; all else 5 and -6
  });
  expectSlices({5, -6, -6, -6, -6, -6});
  // Each slice has a scale of its own: what is padding in both is -2 and 2 there.
  image.words = {-2, 0, 1, 4, 5, 6};
  WrittenItem other = imageSet(image);
  placeAt(other, "0\\0\\2");
  scale("-1", "0")(other);
  range(-2, -2)(other);
  WrittenItem first = imageSet(image);
  placeAt(first, "0\\0\\0");
  scale("1", "0")(first);
  range(-2, -2)(first);
  writeFile(folder_.file("s0.dcm"), DicomWriter(kLittleEndianDicom).file(first));
  writeFile(folder_.file("s1.dcm"), DicomWriter(kLittleEndianDicom).file(other));
  // All else goes from -6 to 6, so that neither -2 nor 2 stays.
  EXPECT_EQ(loadVolume(folder_.path()).toDense(), (Floats{-6, 0, 1, 4, 5, 6, -6, 0, -1, -4, -5, -6}));
  // All else is 0 to 6 in the first slice and 0 to 6 in the second: -2 stays, 2 becomes -2, the lowest.
  scale("1", "0")(other);
  other[0x7fe00010] = numbersOf("OW", {2, 0, 1, 4, 5, 6});
  range(2, 2)(other);
  writeFile(folder_.file("s1.dcm"), DicomWriter(kLittleEndianDicom).file(other));
  EXPECT_EQ(loadVolume(folder_.path()).toDense(), (Floats{-2, 0, 1, 4, 5, 6, -2, 0, 1, 4, 5, 6}));
  EXPECT_EQ(
      loadVolume(folder_.path()).facts().remark,
      "2 of 12 pixels are padding in the files; 1 of these keep their densities, which no other is below; 1 of 12 "
      "voxels have no value and are -2 here, the lowest density (--nan gives another)");
}

// Some scanners write -2000 into whole words of which twelve bits are stored.
TEST_F(DicomValuesOfSeries, OfPaddingBeyondTheStoredBitsAreWholeWords) {
  for (const bool is_signed : {true, false}) {
    WrittenImage image;
    image.bits_stored = 12;
    image.high_bit = 11;
    image.is_signed = is_signed;
    image.words = {0x07ff, 0xf830, 0x0000, 0x0030, 0x0830, 0x0001};  // 0xf830: -2000 in 16 bits; -2000 & 0xfff = 0x830
    write(image, [&](WrittenItem& set) { set[0x00280120] = numbersOf(is_signed ? "SS" : "US", {-2000}); });
    if (is_signed) {  // -2000 fits twelve signed bits: it is a stored value
      expectSlices({2047, -9, 0, 48, -9, 1}, "?nan=-9");
    } else {
      expectSlices({2047, -9, 0, 48, 2096, 1}, "?nan=-9");
      EXPECT_THAT(loadVolume(folder_.path()).facts().remark, testing::HasSubstr("2 of 12 pixels are padding"));
    }
    write(image, [&](WrittenItem& set) { set[0x00280120] = numbersOf("SS", {-3000}); });
    expectSlices(is_signed ? Floats{2047, -2000, 0, 48, -2000, 1} : Floats{2047, 2096, 0, 48, 2096, 1});
  }
  // The end of a range alone does not fit.
  WrittenImage image;
  image.bits_stored = 12;
  image.high_bit = 11;
  image.words = {0x07ff, 0xf000, 0xf448, 0x0000, 0x0448, 0xffff};  // 2047, -4096, -3000, 0, 1096, -1
  write(image, [](WrittenItem& set) {
    set[0x00280120] = numbersOf("SS", {-4096});
    set[0x00280121] = numbersOf("SS", {-2000});
  });
  expectSlices({2047, -9, -9, 0, 1096, -1}, "?nan=-9");
}

TEST_F(DicomValuesOfSeries, OfPaddingAreRefusedWhereNothingElseIs) {
  WrittenImage image = ramp();
  image.words = std::vector<std::int64_t>(6, -5);
  write(image, [](WrittenItem& set) { set[0x00280120] = numbersOf("SS", {-5}); });
  refuses("all of its 12 pixels are padding (PixelPaddingValue)");
  write(ramp(), [](WrittenItem& set) { set[0x00280120] = numbersOf("SS", {-5, -6}); });
  refuses("the PixelPaddingValue of slice s0.dcm is not one number of 16 bits");
  write(ramp(), [](WrittenItem& set) { set[0x00280121] = numbersOf("SS", {-5}); });
  refuses("slice s0.dcm has a PixelPaddingRangeLimit and no PixelPaddingValue");
}

// --- where pixels lie -----------------------------------------------------------------------------------------------

TEST_F(DicomValuesOfSeries, AreRefusedWhereNobodyKnowsTheOrderOfBytes) {
  WrittenImage image = ramp();
  image.bits_allocated = image.bits_stored = 8;
  image.high_bit = 7;
  image.words = {1, 2, 3, 4, 5, -6};
  for (const bool as_words : {false, true}) {
    image.as_words = as_words;
    for (const char* syntax : {kLittleEndianDicom, kImplicitDicom, kDeflatedDicom}) {
      write(image, {}, true, syntax);
      expectSlices({1, 2, 3, 4, 5, -6});
    }
    write(image, {}, true, kBigEndianDicom);
    if (as_words) {
      refuses("slice s0.dcm holds two pixels in a word, in big-endian order");
    } else {
      expectSlices({1, 2, 3, 4, 5, -6});
    }
  }
  write(ramp(), {}, true, "1.2.840.10008.1.2.4.70");
  refuses("the pixels of slice s0.dcm are plain bytes, which its transfer syntax 1.2.840.10008.1.2.4.70 does not say");
}

// GDCM unpacks, and the words mean what they would mean if they were not packed.
class PackedValues : public DicomValuesOfSeries, public testing::WithParamInterface<DicomPacking> {};
INSTANTIATE_TEST_SUITE_P(Packings, PackedValues,
                         testing::Values(DicomPacking::kRle, DicomPacking::kJpegLossless, DicomPacking::kJpegLs,
                                         DicomPacking::kJpeg2000));

TEST_P(PackedValues, AreThoseOfPlainPixels) {
  for (const int allocated : {8, 16}) {
    for (const int stored : {8, 10, 12, 14, 16}) {
      if (stored > allocated) continue;
      for (const bool is_signed : {false, true}) {
        for (const char* meaning : {"MONOCHROME1", "MONOCHROME2"}) {
          SCOPED_TRACE(fmt::format("{} {} {} {}", allocated, stored, is_signed, meaning));
          WrittenImage image;
          image.rows = image.columns = 16;
          image.bits_allocated = allocated;
          image.bits_stored = stored;
          image.high_bit = stored - 1;
          image.is_signed = is_signed;
          image.meaning = meaning;
          Floats want;
          const std::int64_t lowest = is_signed ? -(std::int64_t{1} << (stored - 1)) : 0;
          for (std::int64_t n = 0; n < 256; ++n) {
            const std::int64_t value = lowest + n * ((std::int64_t{1} << stored) - 1) / 255;
            image.words.push_back(value & ((std::int64_t{1} << stored) - 1));
            want.push_back(static_cast<float>(3 * value + 5));
          }
          write(image, scale("3", "5"));
          expectSlices(want);
          for (const char* name : {"s0.dcm", "s1.dcm"})
            writeFile(folder_.file(name), packedDicom(readFile(folder_.file(name)), GetParam()));
          expectSlices(want);
        }
      }
    }
  }
}

// GDCM ends the process over a frame of less than 8 bits, which Debian's assertions do not foresee.
TEST_F(DicomValuesOfSeries, OfLessThanEightBitsAreNotReadFromJpeg) {
  WrittenImage image;
  image.rows = image.columns = 16;
  image.bits_allocated = image.bits_stored = 8;
  image.high_bit = 7;
  image.is_signed = false;
  for (int n = 0; n < 256; ++n) image.words.push_back(n / 2);
  write(image);
  for (const char* name : {"s0.dcm", "s1.dcm"}) {
    std::string packed = packedDicom(readFile(folder_.file(name)), DicomPacking::kJpegLossless);
    for (const auto& [element, from, to] : {std::array{0x101, 8, 7}, {0x102, 7, 6}}) {
      const auto us = [](int value) { return bytesOf<std::uint16_t>({static_cast<double>(value)}); };
      const std::string old = dicomElement(0x28, element, "US", us(from));
      packed.replace(packed.find(old), old.size(), dicomElement(0x28, element, "US", us(to)));
    }
    writeFile(folder_.file(name), packed);
  }
  refuses("slice s0.dcm is packed, and has 7 bits (BitsStored) in pixels of 8; unpack the series in another program");
}

// Words of 16 bits of which 8 are stored: a codec may pack these alone, in bytes.
TEST_P(PackedValues, OfEightBitsInWiderWordsAreWidened) {
  for (const bool is_signed : {false, true}) {
    for (const auto& [allocated, stored] : {std::pair{16, 8}, {32, 8}, {16, 7}}) {
      if (allocated == 32 && GetParam() == DicomPacking::kJpegLossless) continue;  // PS3.5, 8.2.1, knows none
      SCOPED_TRACE(fmt::format("{} {} {}", is_signed, allocated, stored));
      WrittenImage image;
      image.rows = image.columns = 16;
      image.bits_allocated = image.bits_stored = 8;
      image.high_bit = 7;
      image.is_signed = is_signed;
      Floats want;
      for (int n = 0; n < 256; ++n) {
        const int value = n % (1 << stored) - (is_signed ? 1 << (stored - 1) : 0);
        image.words.push_back(value & 255);
        want.push_back(static_cast<float>(value));
      }
      write(image);
      for (const char* name : {"s0.dcm", "s1.dcm"}) {
        std::string packed = packedDicom(readFile(folder_.file(name)), GetParam());
        const auto us = [](int value) { return bytesOf<std::uint16_t>({static_cast<double>(value)}); };
        for (const auto& [element, from, to] :
             {std::array{0x100, 8, allocated}, {0x101, 8, stored}, {0x102, 7, stored - 1}}) {
          const std::string old = dicomElement(0x28, element, "US", us(from));
          packed.replace(packed.find(old), old.size(), dicomElement(0x28, element, "US", us(to)));
        }
        writeFile(folder_.file(name), packed);
      }
      if (GetParam() == DicomPacking::kRle) {
        refuses("slice s0.dcm is cut short or damaged");  // a byte plane is missing
      } else {
        expectSlices(want);
      }
    }
  }
}

// The file says afterwards that the coding loses something and that twelve bits are stored, as if it had overshot.
TEST_F(DicomValuesOfSeries, OfLossyPackingAreClampedWhereTheyOvershoot) {
  for (const auto& [packing, lossless, lossy] :
       {std::tuple{DicomPacking::kJpegLossless, "1.2.840.10008.1.2.4.70", "1.2.840.10008.1.2.4.51"},
        {DicomPacking::kJpegLs, "1.2.840.10008.1.2.4.80", "1.2.840.10008.1.2.4.81"},
        {DicomPacking::kJpeg2000, "1.2.840.10008.1.2.4.90", "1.2.840.10008.1.2.4.91"}}) {
    SCOPED_TRACE(lossy);
    WrittenImage image;
    image.rows = image.columns = 16;
    image.is_signed = false;
    Floats want;
    for (int n = 0; n < 256; ++n) {
      image.words.push_back(n < 3 ? 4096 + 900 * n : 16 * n);
      want.push_back(static_cast<float>(std::min<std::int64_t>(4095, image.words.back())));
    }
    for (const bool loses : {false, true}) {
      write(image);
      for (const char* name : {"s0.dcm", "s1.dcm"}) {
        std::string packed = packedDicom(readFile(folder_.file(name)), packing);
        const auto replace = [&](const std::string& old, const std::string& by) {
          ASSERT_NE(packed.find(old), std::string::npos);
          packed.replace(packed.find(old), old.size(), by);
        };
        const auto us = [](int value) { return bytesOf<std::uint16_t>({static_cast<double>(value)}); };
        if (loses) replace(lossless, lossy);
        replace(dicomElement(0x28, 0x101, "US", us(16)), dicomElement(0x28, 0x101, "US", us(12)));
        replace(dicomElement(0x28, 0x102, "US", us(15)), dicomElement(0x28, 0x102, "US", us(11)));
        writeFile(folder_.file(name), packed);
      }
      if (loses) {
        expectSlices(want);
        EXPECT_EQ(loadVolume(folder_.path()).facts().remark,
                  "6 of 512 pixels, packed with losses, lay beyond BitsStored and were held within it");
        EXPECT_EQ(loadVolume(folder_.path()).facts().clamped, 6U);
      } else {
        refuses("the packed pixels of slice s0.dcm have more bits than BitsStored, 12");
      }
    }
  }
}

// 63536, -2000 in 16 bits, of which twelve are stored: it is padding, neither too many bits nor an overshoot.
TEST_P(PackedValues, OfPaddingBeyondTheStoredBitsAreWholeWords) {
  WrittenImage image;
  image.rows = image.columns = 16;
  image.is_signed = false;
  Floats want;
  for (int n = 0; n < 256; ++n) {
    image.words.push_back(n < 3 ? 63536 : 16 * n);
    want.push_back(n < 3 ? -9 : static_cast<float>(16 * n));
  }
  write(image, [](WrittenItem& set) { set[0x00280120] = numbersOf("US", {63536}); });
  for (const char* name : {"s0.dcm", "s1.dcm"}) {
    std::string packed = packedDicom(readFile(folder_.file(name)), GetParam());
    const auto us = [](int value) { return bytesOf<std::uint16_t>({static_cast<double>(value)}); };
    for (const auto& [element, from, to] : {std::array{0x101, 16, 12}, {0x102, 15, 11}}) {
      const std::string old = dicomElement(0x28, element, "US", us(from));
      ASSERT_NE(packed.find(old), std::string::npos);
      packed.replace(packed.find(old), old.size(), dicomElement(0x28, element, "US", us(to)));
    }
    writeFile(folder_.file(name), packed);
  }
  expectSlices(want, "?nan=-9");
  EXPECT_EQ(loadVolume(folder_.path() + "?nan=-9").facts().replaced, 6U);
}

// A video, HTJ2K, JPEG XL: the file is whole.
TEST_F(DicomValuesOfSeries, PackedInAnUnknownWayAreRefusedByItsName) {
  write(ramp());
  for (const char* syntax : {"1.2.840.10008.1.2.4.102", "1.2.840.10008.1.2.4.201", "1.2.840.10008.1.2.4.110",
                             "1.2.840.10008.1.2.1.98", "1.2.3.4"}) {
    write(
        ramp(),
        [](WrittenItem& set) {
          set[0x7fe00010] = textOf("OB", "");
          set[0x7fe00010].fragments = {"anything"};
        },
        true, syntax);
    refuses(
        fmt::format("slice s0.dcm is packed as {}, which Palpate does not read; unpack the series in another "
                    "program",
                    syntax));
  }
}

// The file says afterwards that twelve bits lie on top: Palpate unpacks RLE itself, and GDCM would not know.
TEST_P(PackedValues, WithAnotherHighBitAreReadFromRleAlone) {
  WrittenImage image;
  image.rows = image.columns = 16;
  for (int n = 0; n < 256; ++n) image.words.push_back(n);
  write(image);
  for (const char* name : {"s0.dcm", "s1.dcm"}) {
    std::string packed = packedDicom(readFile(folder_.file(name)), GetParam());
    const auto replace = [&](int element, int from, int to) {
      const auto us = [](int value) { return bytesOf<std::uint16_t>({static_cast<double>(value)}); };
      const std::string old = dicomElement(0x28, element, "US", us(from));
      packed.replace(packed.find(old), old.size(), dicomElement(0x28, element, "US", us(to)));
    };
    replace(0x101, 16, 12);
    writeFile(folder_.file(name), packed);
  }
  if (GetParam() == DicomPacking::kRle) {
    Floats want;
    for (int n = 0; n < 256; ++n) want.push_back(static_cast<float>(n / 16));
    return expectSlices(want);
  }
  refuses("slice s0.dcm is packed, and the highest of its 12 bits (BitsStored) is bit 15 (HighBit)");
}

}  // namespace dicom_values_test
}  // namespace palpate
