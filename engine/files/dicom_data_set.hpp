// SPDX-License-Identifier: Apache-2.0
// engine/files/dicom_data_set.hpp: the elements of a DICOM file that Palpate reads. Private to engine/files. Any
// thread.
//
// Source: DICOM PS3.5, chapter 7 (data set structure); names and tags are those of PS3.6.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace palpate {

enum class DicomTag : std::uint32_t {
  kSeriesDescription = 0x0008103e,
  kSpacingBetweenSlices = 0x00180088,
  kSeriesInstanceUid = 0x0020000e,
  kImagePositionPatient = 0x00200032,
  kImageOrientationPatient = 0x00200037,
  kStackId = 0x00209056,
  kFrameContentSequence = 0x00209111,
  kPlanePositionSequence = 0x00209113,
  kPlaneOrientationSequence = 0x00209116,
  kTemporalPositionIndex = 0x00209128,
  kDimensionIndexValues = 0x00209157,
  kDimensionIndexPointer = 0x00209165,
  kDimensionIndexSequence = 0x00209222,
  kDimensionDescriptionLabel = 0x00209421,
  kSamplesPerPixel = 0x00280002,
  kPhotometricInterpretation = 0x00280004,
  kNumberOfFrames = 0x00280008,
  kRows = 0x00280010,
  kColumns = 0x00280011,
  kPixelSpacing = 0x00280030,
  kBitsAllocated = 0x00280100,
  kBitsStored = 0x00280101,
  kHighBit = 0x00280102,
  kPixelRepresentation = 0x00280103,
  kPixelPaddingValue = 0x00280120,
  kPixelPaddingRangeLimit = 0x00280121,
  kRescaleIntercept = 0x00281052,
  kRescaleSlope = 0x00281053,
  kModalityLutSequence = 0x00283000,
  kLutDescriptor = 0x00283002,
  kLutData = 0x00283006,
  kPixelMeasuresSequence = 0x00289110,
  kPixelValueTransformationSequence = 0x00289145,
  kSharedFunctionalGroupsSequence = 0x52009229,
  kPerFrameFunctionalGroupsSequence = 0x52009230,
  kFloatPixelData = 0x7fe00008,
  kDoubleFloatPixelData = 0x7fe00009,
  kPixelData = 0x7fe00010
};

struct DicomItem;

struct DicomElement {
  std::string type;                    // "US"; empty where the file does not say
  std::string bytes;                   // text, or the entries of a table as they lie in the file
  std::vector<std::uint32_t> numbers;  // of an element of 16 or 32-bit numbers, as if none had a sign
  std::vector<DicomItem> items;        // of a sequence
};

// A data set, or an item of a sequence. An element that holds nothing counts as missing.
struct DicomItem {
  std::map<DicomTag, DicomElement> elements;

  [[nodiscard]] bool has(DicomTag tag) const { return elements.contains(tag); }
  // A missing element gives one that holds nothing.
  [[nodiscard]] const DicomElement& element(DicomTag tag) const;
  // The first number of an element; `otherwise` if it has none.
  [[nodiscard]] std::uint32_t number(DicomTag tag, std::uint32_t otherwise) const;
  // The first item of a sequence; null if there is none. The sequences that are looked into so have one item.
  [[nodiscard]] const DicomItem* item(DicomTag sequence) const;
  // Without the blanks and zeros around it.
  [[nodiscard]] std::string text(DicomTag tag) const;
};

struct DicomDataSet {
  DicomItem root;
  std::string syntax;  // the UID of its transfer syntax; "": the head names none
  bool deflated = false;
  bool swapped = false;    // its numbers, against the machine's byte order
  std::size_t frames = 1;  // one at least
  bool has_pixels = false;
  bool packed = false;     // the pixels are in fragments; they are bytes from `pixel_offset` on otherwise
  bool floating = false;   // there are pixels that are floating-point numbers
  std::string pixel_type;  // "OW"; empty where the file does not say
  struct Fragment {
    std::uint64_t offset = 0, bytes = 0;
  };
  std::vector<Fragment> rle_frames;  // one for each frame, if they are packed as RLE
  std::uint64_t pixel_offset = 0;    // in the file, or for a deflated file in what it unpacks to [byte]

  // GDCM unpacks the pixels (gdcm_child.hpp); others are read here.
  [[nodiscard]] bool unpackedByGdcm() const { return packed && rle_frames.empty(); }
};

}  // namespace palpate
