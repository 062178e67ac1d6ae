// SPDX-License-Identifier: Apache-2.0
// What pixels become that DICOM files name as padding (PS3.3, C.7.5.1.1.2), plain ones.
#include "engine/files/dicom_padding.hpp"

#include <fmt/format.h>

#include "tests/engine/files/two_dicom_slices.hpp"

namespace palpate {
namespace dicom_padding_test {

using Floats = std::vector<float>;

class DicomPadding : public TwoDicomSlices {};

TEST_F(DicomPadding, IsTheLowestDensityOrWhatTheUserSays) {
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
TEST_F(DicomPadding, StaysWhereNothingIsBelow) {
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
TEST_F(DicomPadding, FarBelowAPictureIsReplaced) {
  for (const std::int64_t padding : {-400, -401, -32768}) {
    WrittenImage image;
    image.words = {padding, 0, 100, 400, 300, padding};
    write(image, [&](WrittenItem& set) { set[0x00280120] = numbersOf("SS", {padding}); });
    const float instead = padding == -400 ? -400 : 0;
    expectSlices({instead, 0, 100, 400, 300, instead});
  }
}

// A mask of which the inside is padding would hold one density if padding became another.
TEST_F(DicomPadding, StaysWhereAllElseHasOneDensity) {
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
TEST_F(DicomPadding, StaysOneByOne) {
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
TEST_F(DicomPadding, BeyondTheStoredBitsIsOfWholeWords) {
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

TEST_F(DicomPadding, IsRefusedWhereNothingElseIs) {
  WrittenImage image = ramp();
  image.words = std::vector<std::int64_t>(6, -5);
  write(image, [](WrittenItem& set) { set[0x00280120] = numbersOf("SS", {-5}); });
  refuses("all of its 12 pixels are padding (PixelPaddingValue)");
  write(ramp(), [](WrittenItem& set) { set[0x00280120] = numbersOf("SS", {-5, -6}); });
  refuses("the PixelPaddingValue of slice s0.dcm is not one number of 16 bits");
  write(ramp(), [](WrittenItem& set) { set[0x00280121] = numbersOf("SS", {-5}); });
  refuses("slice s0.dcm has a PixelPaddingRangeLimit and no PixelPaddingValue");
}

}  // namespace dicom_padding_test
}  // namespace palpate
