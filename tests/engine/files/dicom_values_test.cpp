// SPDX-License-Identifier: Apache-2.0
// What the words of DICOM images mean, worked out by hand from PS3.5, 8.1.1, and PS3.3, C.7.5.1.1.2 and C.11.1.
#include "engine/files/dicom_values.hpp"

#include <fmt/format.h>

#include "engine/field/finite_values.hpp"
#include "tests/engine/files/two_dicom_slices.hpp"

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

// White where values are low: that is how it is shown, and says nothing of what was measured.
TEST_F(TwoDicomSlices, AreTheSameHoweverTheyAreShown) {
  for (const char* meaning : {"MONOCHROME1", "MONOCHROME2"}) {
    WrittenImage image = ramp();
    image.meaning = meaning;
    write(image, scale("2", "-100"));
    expectSlices({-100, -98, -96, -102, 100, 65434});
  }
}

TEST_F(TwoDicomSlices, LieInTheBitsThatTheFileNames) {
  WrittenImage image;
  image.bits_stored = 12;
  image.high_bit = 13;
  image.words = {0x0004, 0xc003, 0x1ffc, 0x2000, 0x3ffc, 0xffff};
  for (const char* syntax : {kLittleEndianDicom, kBigEndianDicom, kImplicitDicom, kDeflatedDicom}) {
    write(image, {}, true, syntax);
    expectSlices({1, 0, 2047, -2048, -1, -1});
  }
}

TEST_F(TwoDicomSlices, AreRefusedInBitsThatDoNotFit) {
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

TEST_F(TwoDicomSlices, AreRefusedIfTheyAreNoGreyValues) {
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

TEST_F(TwoDicomSlices, AreRefusedWhereOnlySomeSlicesAreScaled) {
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
TEST_F(TwoDicomSlices, AreScaledByWhatTheFilesHaveOfSlopeAndIntercept) {
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
TEST_F(TwoDicomSlices, OfMrAreScaledAsThoseOfCt) {
  write(ramp(), [](WrittenItem& set) {
    set[0x00080016] = textOf("UI", "1.2.840.10008.5.1.4.1.1.4");
    set[0x00080060] = textOf("CS", "MR");
    scale("0.5", "-3")(set);
  });
  expectSlices({-3, -2.5F, -2, -3.5F, 47, 16380.5F});
}

TEST_F(TwoDicomSlices, ComeFromTheTableOfTheFile) {
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

TEST_F(TwoDicomSlices, AreRefusedWithATableThatIsNotClear) {
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
TEST_F(TwoDicomSlices, ThatNoFloatHoldsAreTold) {
  write(ramp(), scale("0.1", "0"));
  const Rounding& rounded = loadVolume(folder_.path()).facts().rounded;
  EXPECT_EQ(rounded.count, 2U * 4);
  EXPECT_EQ(rounded.of, "scaled int16");
  write(ramp(), scale("0.5", "-100"));
  EXPECT_EQ(loadVolume(folder_.path()).facts().rounded.count, 0U);
}

// --- where pixels lie -----------------------------------------------------------------------------------------------

TEST_F(TwoDicomSlices, AreRefusedWhereNobodyKnowsTheOrderOfBytes) {
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

}  // namespace dicom_values_test
}  // namespace palpate
