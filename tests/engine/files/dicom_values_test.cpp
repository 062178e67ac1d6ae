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
std::vector<float> densitiesOf(const DicomValueRule& rule, const std::vector<Word>& words) {
  std::vector<float> densities(words.size());
  toDensities(rule, {reinterpret_cast<const char*>(words.data()), words.size() * sizeof(Word)}, densities);
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

TEST(DicomValues, ComeFromTheTableWhereThereIsOne) {
  DicomValueRule rule = bits(16, 16, 15, true);
  rule.table = {10, 20, 40, 65535};
  rule.first_mapped = -1;
  // What lies below the first entry's value has the first entry, what lies above the last the last.
  EXPECT_EQ(densitiesOf(rule, Shorts{0x8000, 0xfffe, 0xffff, 0, 1, 2, 3, 0x7fff}),
            (Floats{10, 10, 10, 20, 40, 65535, 65535, 65535}));
}

TEST(DicomValues, OfPaddingAreNone) {
  DicomValueRule rule = bits(16, 12, 11, true);
  rule.padding = {-2048, -2046};
  rule.slope = 2;
  const Floats densities = densitiesOf(rule, Shorts{0x0800, 0x0802, 0x0803, 0x07ff});
  EXPECT_TRUE(isNoValue(densities[0]));
  EXPECT_TRUE(isNoValue(densities[1]));
  EXPECT_EQ(densities[2], -4090);
  EXPECT_EQ(densities[3], 4094);
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
  write(ramp(), scale("2", ""));
  refuses("slice s0.dcm has a RescaleSlope and no RescaleIntercept");
  write(ramp(), scale("", "2"));
  refuses("slice s0.dcm has a RescaleIntercept and no RescaleSlope");
  write(
      ramp(),
      [](WrittenItem& set) {
        set[0x00283000] = table({2, 0, 16}, numbersOf("OW", {5, 6}));
      },
      false);
  refuses("slice s1.dcm has a ModalityLUTSequence, and slice s0.dcm has none");
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
}

// --- padding --------------------------------------------------------------------------------------------------------

TEST_F(DicomValuesOfSeries, OfPaddingAreTheLowestDensityOrWhatTheUserSays) {
  const auto padded = [&](WrittenItem& set) {
    scale("2", "-100")(set);
    set[0x00280120] = numbersOf("SS", {-1});
  };
  write(ramp(), padded);
  expectSlices({-100, -98, -96, -100, 100, 65434});  // -100: of the stored 0
  EXPECT_EQ(loadVolume(folder_.path()).facts().remark,
            "2 of 12 pixels are padding in the files; 2 of 12 voxels have no value and are -100 here, the lowest "
            "density (--nan gives another)");
  expectSlices({-100, -98, -96, -7, 100, 65434}, "?nan=-7");
  EXPECT_EQ(loadVolume(folder_.path() + "?nan=-7").facts().remark,
            "2 of 12 pixels are padding in the files; 2 of 12 voxels have no value and are -7 here");
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
