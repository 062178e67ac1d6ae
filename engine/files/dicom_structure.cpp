// SPDX-License-Identifier: Apache-2.0
#include "engine/files/dicom_structure.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string>

#include "engine/files/dicom_rle.hpp"
#include "engine/files/unpacker.hpp"

namespace palpate {
namespace {

using namespace std::string_view_literals;

constexpr bool kLittleEndian = std::endian::native == std::endian::little;
constexpr std::size_t kPreamble = 132;  // 128 bytes of anything and "DICM"
constexpr std::uint32_t kUndefined = 0xffffffffU;
constexpr std::uint32_t kItem = 0xfffee000U;
constexpr std::uint32_t kItemEnd = 0xfffee00dU;
constexpr std::uint32_t kSequenceEnd = 0xfffee0ddU;
constexpr std::uint32_t kObjectClass = 0x00020002U;
constexpr std::uint32_t kTransferSyntax = 0x00020010U;
constexpr double kMostFrames = 1e9;
constexpr int kDeepest = 32;  // nested sequences
constexpr std::string_view kImplicit = "1.2.840.10008.1.2";
constexpr std::string_view kExplicit = "1.2.840.10008.1.2.1";
constexpr std::string_view kDeflated = "1.2.840.10008.1.2.1.99";
constexpr std::string_view kRle = "1.2.840.10008.1.2.5";
constexpr std::string_view kBigEndian = "1.2.840.10008.1.2.2";
constexpr std::size_t kMostInflated = std::size_t{512} << 20;  // one slice of the largest detector has 60 MiB [byte]

// What the value of an element that Palpate reads is.
enum class Kind { kText, kWords, kLongs, kTable, kItems };

std::optional<Kind> kindOf(DicomTag tag) {
  using enum DicomTag;
  switch (tag) {
    case kSamplesPerPixel:
    case kRows:
    case kColumns:
    case kBitsAllocated:
    case kBitsStored:
    case kHighBit:
    case kPixelRepresentation:
    case kPixelPaddingValue:
    case kPixelPaddingRangeLimit:
    case kLutDescriptor:
    case kDimensionIndexPointer:  // the two halves of a tag
      return Kind::kWords;
    case kTemporalPositionIndex:
    case kDimensionIndexValues:
      return Kind::kLongs;
    case kLutData:
      return Kind::kTable;
    case kFrameContentSequence:
    case kDimensionIndexSequence:
    case kPlanePositionSequence:
    case kPlaneOrientationSequence:
    case kModalityLutSequence:
    case kPixelMeasuresSequence:
    case kPixelValueTransformationSequence:
    case kSharedFunctionalGroupsSequence:
    case kPerFrameFunctionalGroupsSequence:
      return Kind::kItems;
    case kSeriesDescription:
    case kSpacingBetweenSlices:
    case kSeriesInstanceUid:
    case kImagePositionPatient:
    case kImageOrientationPatient:
    case kStackId:
    case kDimensionDescriptionLabel:
    case kPhotometricInterpretation:
    case kNumberOfFrames:
    case kPixelSpacing:
    case kRescaleIntercept:
    case kRescaleSlope:
      return Kind::kText;
    case kFloatPixelData:
    case kDoubleFloatPixelData:
    case kPixelData:
      break;
  }
  return {};
}

struct Element {
  std::uint32_t tag = 0;
  std::string_view type;  // "OW"; empty where the syntax is implicit and for items
  std::uint32_t length = 0;
};

// `names`: the known ones in a row, two letters each.
bool isOneOf(std::string_view names, std::string_view type) {
  for (std::size_t n = 0; n < names.size(); n += 3) {
    if (names.substr(n, 2) == type) return true;
  }
  return false;
}

// `ends`: of the transfer syntaxes, two digits each.
bool isJpeg(std::string_view syntax, std::string_view ends) {
  constexpr std::string_view kJpeg = "1.2.840.10008.1.2.4.";
  return syntax.size() == kJpeg.size() + 2 && syntax.starts_with(kJpeg) && isOneOf(ends, syntax.substr(kJpeg.size()));
}

class Walk {
 public:
  explicit Walk(std::string_view file) : file_(file) {}

  // The head names the file's class and the coding of the rest. It is always explicit and little-endian, and never
  // deflated.
  struct Head {
    std::string_view object_class, syntax;
  };
  std::optional<Head> head() {
    at_ = kPreamble;
    Head head;
    while (at_ + 8 <= file_.size() && peekTag() >> 16U == 2) {
      Element element;
      if (!readHead(element) || element.length > left()) return std::nullopt;
      std::string_view value = file_.substr(at_, element.length);
      while (!value.empty() && (value.back() == '\0' || value.back() == ' ')) value.remove_suffix(1);
      if (element.tag == kObjectClass) head.object_class = value;
      if (element.tag == kTransferSyntax) head.syntax = value;
      at_ += element.length;
    }
    return head;
  }

  // What follows the head.
  [[nodiscard]] std::string_view rest() const { return file_.substr(at_); }

  std::optional<DicomDataSet> wholeFile() {
    const std::optional<Head> known = head();
    if (!known) return {};
    set_.syntax = known->syntax;
    explicit_ = set_.syntax != kImplicit;
    rle_ = set_.syntax == kRle;
    swapped_ = (set_.syntax == kBigEndian) == kLittleEndian;
    set_.swapped = swapped_;
    set_.deflated = set_.syntax == kDeflated;
    std::optional<std::string> unpacked;
    if (set_.deflated) {
      unpacked = inflated(rest(), kMostInflated);
      if (!unpacked) return {};
      file_ = *unpacked;
      at_ = 0;
    }
    if (!elements(0, &set_.root)) return {};
    set_.frames = static_cast<std::size_t>(std::min(frames(), kMostFrames));
    return std::move(set_);
  }

 private:
  // Elements up to the file's end; those of an item up to its delimiter. `to`: takes what Palpate reads; null: nothing.
  bool elements(int depth, DicomItem* to) {
    std::uint32_t last_tag = 0;
    while (at_ < file_.size()) {
      Element element;
      if (!readHead(element)) return false;
      if (element.tag == kItemEnd) return depth > 0;
      if (element.tag <= last_tag) return false;  // tags ascend
      last_tag = element.tag;
      if (!value(element, depth, to)) return false;
    }
    return depth == 0;
  }

  bool value(const Element& element, int depth, DicomItem* to) {
    const auto tag = static_cast<DicomTag>(element.tag);
    const std::optional<Kind> kind = to == nullptr ? std::nullopt : kindOf(tag);
    if (depth == 0) notePixels(tag, element);
    const bool open = element.length == kUndefined;
    if (!open && element.length > left()) return false;
    if (open || element.type == "SQ" || kind == Kind::kItems) {
      packed_ = open && rle_ && depth == 0 && tag == DicomTag::kPixelData;
      std::vector<DicomItem> found;
      if (!sequence(element, open, depth, kind == Kind::kItems ? &found : nullptr)) return false;
      if (!found.empty()) to->elements[tag] = {std::string(element.type), "", {}, std::move(found)};
      return true;
    }
    if (kind && element.length > 0) keep(element, *kind, *to);
    if (tag == DicomTag::kPixelData && depth == 0 && !pixelsFit(element)) return false;
    at_ += element.length;
    return true;
  }

  // A sequence whose type nobody knows, UN, is written as in the implicit syntax (PS3.5, 6.2.2).
  bool sequence(const Element& element, bool open, int depth, std::vector<DicomItem>* to) {
    const bool as_explicit = explicit_;
    const bool as_swapped = swapped_;
    if (element.type == "UN") {
      explicit_ = false;
      swapped_ = !kLittleEndian;
    }
    const bool good = items(open ? file_.size() : at_ + element.length, open, depth + 1, to);
    explicit_ = as_explicit;
    swapped_ = as_swapped;
    return good;
  }

  void keep(const Element& element, Kind kind, DicomItem& to) const {
    DicomElement kept;
    kept.type = element.type;
    const std::size_t end = at_ + element.length;
    if (kind == Kind::kWords) {
      for (std::size_t at = at_; at + 2 <= end; at += 2) kept.numbers.push_back(number<std::uint16_t>(at));
    } else if (kind == Kind::kLongs) {
      for (std::size_t at = at_; at + 4 <= end; at += 4) kept.numbers.push_back(number<std::uint32_t>(at));
    } else {
      kept.bytes = file_.substr(at_, element.length);
    }
    to.elements[static_cast<DicomTag>(element.tag)] = std::move(kept);
  }

  void notePixels(DicomTag tag, const Element& element) {
    if (tag == DicomTag::kFloatPixelData || tag == DicomTag::kDoubleFloatPixelData) set_.floating = true;
    if (tag != DicomTag::kPixelData) return;
    set_.has_pixels = true;
    set_.packed = element.length == kUndefined;
    set_.pixel_type = element.type;
    set_.pixel_offset = at_;
  }

  // Of the image; `otherwise` where the file does not say.
  [[nodiscard]] double said(DicomTag tag, std::uint32_t otherwise) const { return set_.root.number(tag, otherwise); }
  // There is at least one frame, one sample and one bit, whatever the file says.
  [[nodiscard]] double frames() const {
    const double number = std::atof(set_.root.text(DicomTag::kNumberOfFrames).c_str());
    return number > 1 ? number : 1;
  }
  [[nodiscard]] double samples() const { return std::max(1.0, said(DicomTag::kSamplesPerPixel, 1)); }
  [[nodiscard]] double bits() const { return std::max(1.0, said(DicomTag::kBitsAllocated, 8)); }
  [[nodiscard]] double pixels() const { return said(DicomTag::kRows, 0) * said(DicomTag::kColumns, 0); }

  // Uncompressed pixels must be as many as rows, columns, samples and bits ask for: they are read from where they lie.
  // Pixels are the last element, so these numbers are known by then.
  [[nodiscard]] bool pixelsFit(const Element& element) const {
    return static_cast<double>(element.length) * 8 >= pixels() * samples() * frames() * bits();
  }

  // The items of a sequence, or the fragments of packed pixels, which are items without elements. `delimited`: they end
  // with a delimiter; otherwise they end at `end`. `to`: takes the items; null: nobody needs them.
  bool items(std::size_t end, bool delimited, int depth, std::vector<DicomItem>* to) {
    if (depth > kDeepest) return false;
    while (at_ < end) {
      Element item;
      if (!readHead(item)) return false;
      if (item.tag == kSequenceEnd) return allFrames() && (delimited || at_ == end);
      if (item.tag != kItem) return false;
      if (item.length == kUndefined) {
        if (!elements(depth, to == nullptr ? nullptr : &to->emplace_back())) return false;
      } else {
        if (item.length > left()) return false;
        if (packed_ && fragments_++ > 0) {  // the first only says where frames begin
          if (!rleFits(file_.substr(at_, item.length), pixels(), rlePlanes())) return false;
          set_.rle_frames.push_back({at_, item.length});
        }
        if (to != nullptr && !closedItem(item.length, depth, to->emplace_back())) return false;
        if (to == nullptr) at_ += item.length;
      }
    }
    return at_ == end && !delimited;
  }

  // The elements of an item of a given length, as if the file ended there.
  bool closedItem(std::size_t length, int depth, DicomItem& to) {
    const std::string_view whole = file_;
    file_ = file_.substr(0, at_ + length);
    std::uint32_t last_tag = 0;
    bool good = true;
    while (good && at_ < file_.size()) {
      Element element;
      good = readHead(element) && element.tag > last_tag && value(element, depth, &to);
      last_tag = element.tag;
    }
    file_ = whole;
    return good;
  }

  // A frame packed as RLE is one fragment. It follows the fragment that says where frames begin.
  [[nodiscard]] bool allFrames() const { return !packed_ || static_cast<double>(fragments_) >= 1 + frames(); }
  [[nodiscard]] double rlePlanes() const { return std::min(15.0, samples() * std::ceil(bits() / 8)); }

  bool readHead(Element& element) {
    if (left() < 8) return false;
    element.tag = peekTag();
    at_ += 4;
    if (!explicit_ || element.tag >> 16U == 0xfffeU) {
      element.length = number<std::uint32_t>(at_);
      at_ += 4;
      return true;
    }
    element.type = file_.substr(at_, 2);
    at_ += 2;
    if (!isOneOf("OB OD OF OL OV OW SQ SV UC UN UR UT UV", element.type)) {
      // GDCM guesses if a type does not exist, and may then take any four bytes for the length.
      if (!isOneOf("AE AS AT CS DA DS DT FD FL IS LO LT PN SH SL SS ST TM UI UL US", element.type)) return false;
      element.length = number<std::uint16_t>(at_);
      at_ += 2;
      return true;
    }
    if (left() < 6) return false;
    element.length = number<std::uint32_t>(at_ + 2);
    at_ += 6;
    return true;
  }

  [[nodiscard]] std::uint32_t peekTag() const {
    return static_cast<std::uint32_t>(number<std::uint16_t>(at_)) << 16U | number<std::uint16_t>(at_ + 2);
  }
  template <class T>
  [[nodiscard]] T number(std::size_t offset) const {
    T value = 0;
    std::memcpy(&value, file_.data() + offset, sizeof value);
    return swapped_ ? swapped(value) : value;
  }
  static std::uint16_t swapped(std::uint16_t value) { return __builtin_bswap16(value); }
  static std::uint32_t swapped(std::uint32_t value) { return __builtin_bswap32(value); }
  [[nodiscard]] std::size_t left() const { return file_.size() - at_; }

  std::string_view file_;
  std::size_t at_ = 0;
  bool explicit_ = true;
  bool swapped_ = !kLittleEndian;  // numbers, against the machine's byte order
  bool rle_ = false;               // pixels are packed as RLE
  bool packed_ = false;            // what follows are fragments of packed pixels
  std::size_t fragments_ = 0;      // fragments so far
  DicomDataSet set_;               // what was found so far
};

}  // namespace

bool dicomIsNoImage(std::string_view file) {
  if (file.size() <= kPreamble) return false;
  const auto head = Walk(file).head();
  if (!head) return false;
  constexpr std::string_view kDirectory = "1.2.840.10008.1.3.10";
  constexpr std::string_view kStored = "1.2.840.10008.5.1.4.1.1.";
  if (head->object_class == kDirectory) return true;
  if (!head->object_class.starts_with(kStored)) return false;
  const std::string_view kind = head->object_class.substr(kStored.size());
  // Waveforms, presentation states, reports, documents.
  for (const std::string_view family : {"9.", "11.", "88.", "104."})
    if (kind.starts_with(family)) return true;
  // Spectra, raw data, registrations, fiducials, surfaces; radiotherapy's structures, plans and treatments. (66.4 is a
  // segmentation, which is an image.)
  for (const std::string_view one : {"4.2", "66", "66.1", "66.2", "66.3", "66.5", "481.3", "481.5", "481.8"})
    if (kind == one) return true;
  return false;
}

bool dicomIsLossy(std::string_view syntax) {
  return isJpeg(syntax, "50 51 52 53 55 81 91");
}

bool gdcmUnpacks(std::string_view syntax) {
  return isJpeg(syntax, "50 51 52 53 55 57 70 80 81 90 91");
}

bool dicomIsPlain(std::string_view syntax) {
  return syntax.empty() || syntax == kImplicit || syntax == kExplicit || syntax == kDeflated || syntax == kBigEndian;
}

std::optional<DicomDataSet> readDicomDataSet(std::string_view file) {
  if (file.size() <= kPreamble) return {};
  return Walk(file).wholeFile();
}

std::optional<std::string> inflatedDicom(std::string_view file) {
  if (file.size() <= kPreamble) return {};
  Walk walk(file);
  if (!walk.head()) return {};
  return inflated(walk.rest(), kMostInflated);
}

}  // namespace palpate
