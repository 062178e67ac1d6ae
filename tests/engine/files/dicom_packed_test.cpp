// SPDX-License-Identifier: Apache-2.0
// What the words of packed DICOM images mean: what they would mean if they were not packed.
#include <fmt/format.h>

#include "tests/engine/files/packed_dicom.hpp"
#include "tests/engine/files/two_dicom_slices.hpp"

namespace palpate {
namespace dicom_packed_test {

using Floats = std::vector<float>;

// GDCM unpacks, and the words mean what they would mean if they were not packed.
class DicomPacked : public TwoDicomSlices {
 protected:
  // An element of the image's description (group 0028), and what it says now and then.
  struct Restated {
    int element, from, to;
  };
  // Packs both slices. Their files afterwards say something else of the pixels, and of the transfer syntax.
  void pack(DicomPacking packing, const std::vector<Restated>& elements = {}, const std::string& syntax = "",
            const std::string& other_syntax = "") const {
    for (const char* name : {"s0.dcm", "s1.dcm"}) {
      std::string packed = packedDicom(readFile(folder_.file(name)), packing);
      const auto replace = [&](const std::string& old, const std::string& by) {
        ASSERT_NE(packed.find(old), std::string::npos);
        packed.replace(packed.find(old), old.size(), by);
      };
      const auto element = [](int number, int value) {
        return dicomElement(0x28, number, "US", bytesOf<std::uint16_t>({static_cast<double>(value)}));
      };
      if (!syntax.empty()) replace(syntax, other_syntax);
      for (const Restated& one : elements) replace(element(one.element, one.from), element(one.element, one.to));
      writeFile(folder_.file(name), packed);
    }
  }
};
class PackedValues : public DicomPacked, public testing::WithParamInterface<DicomPacking> {};
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
TEST_F(DicomPacked, OfLessThanEightBitsAreNotReadFromJpeg) {
  WrittenImage image;
  image.rows = image.columns = 16;
  image.bits_allocated = image.bits_stored = 8;
  image.high_bit = 7;
  image.is_signed = false;
  for (int n = 0; n < 256; ++n) image.words.push_back(n / 2);
  write(image);
  pack(DicomPacking::kJpegLossless, {{0x101, 8, 7}, {0x102, 7, 6}});
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
      pack(GetParam(), {{0x100, 8, allocated}, {0x101, 8, stored}, {0x102, 7, stored - 1}});
      if (GetParam() == DicomPacking::kRle) {
        refuses("slice s0.dcm is cut short or damaged");  // a byte plane is missing
      } else {
        expectSlices(want);
      }
    }
  }
}

// The file says afterwards that the coding loses something and that twelve bits are stored, as if it had overshot.
TEST_F(DicomPacked, OfLossyPackingAreClampedWhereTheyOvershoot) {
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
      pack(packing, {{0x101, 16, 12}, {0x102, 15, 11}}, loses ? lossless : "", loses ? lossy : "");
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
  pack(GetParam(), {{0x101, 16, 12}, {0x102, 15, 11}});
  expectSlices(want, "?nan=-9");
  EXPECT_EQ(loadVolume(folder_.path() + "?nan=-9").facts().replaced, 6U);
}

// A video, HTJ2K, JPEG XL: the file is whole.
TEST_F(DicomPacked, PackedInAnUnknownWayAreRefusedByItsName) {
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
  pack(GetParam(), {{0x101, 16, 12}});
  if (GetParam() == DicomPacking::kRle) {
    Floats want;
    for (int n = 0; n < 256; ++n) want.push_back(static_cast<float>(n / 16));
    return expectSlices(want);
  }
  refuses("slice s0.dcm is packed, and the highest of its 12 bits (BitsStored) is bit 15 (HighBit)");
}

}  // namespace dicom_packed_test
}  // namespace palpate
