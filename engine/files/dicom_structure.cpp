// SPDX-License-Identifier: Apache-2.0
#include "engine/files/dicom_structure.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string>

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
constexpr std::uint32_t kTransferSyntax = 0x00020010U;
constexpr std::uint32_t kSamples = 0x00280002U;
constexpr std::uint32_t kFrames = 0x00280008U;
constexpr std::uint32_t kRows = 0x00280010U;
constexpr std::uint32_t kColumns = 0x00280011U;
constexpr std::uint32_t kBitsAllocated = 0x00280100U;
constexpr std::uint32_t kPixels = 0x7fe00010U;
constexpr int kDeepest = 32;  // nested sequences
constexpr std::string_view kImplicit = "1.2.840.10008.1.2";
constexpr std::string_view kDeflated = "1.2.840.10008.1.2.1.99";
constexpr std::string_view kBigEndian = "1.2.840.10008.1.2.2";
constexpr std::size_t kMostInflated = std::size_t{512} << 20;  // one slice of the largest detector has 60 MiB [byte]

struct Element {
  std::uint32_t tag = 0;
  std::string_view type;  // "OW"; empty where the syntax is implicit and for items
  std::uint32_t length = 0;
};

// `names` in a row, two letters each.
bool isOneOf(std::string_view names, std::string_view type) {
  for (std::size_t n = 0; n < names.size(); n += 3) {
    if (names.substr(n, 2) == type) return true;
  }
  return false;
}

class Walk {
 public:
  explicit Walk(std::string_view file) : file_(file) {}

  bool wholeFile() {
    at_ = kPreamble;
    std::string_view syntax;  // what says so is always explicit and little-endian, and never deflated
    while (at_ + 8 <= file_.size() && peekTag() >> 16U == 2) {
      Element element;
      if (!readHead(element) || element.length > left()) return false;
      if (element.tag == kTransferSyntax) syntax = file_.substr(at_, element.length);
      at_ += element.length;
    }
    while (!syntax.empty() && (syntax.back() == '\0' || syntax.back() == ' ')) syntax.remove_suffix(1);
    explicit_ = syntax != kImplicit;
    swapped_ = (syntax == kBigEndian) == kLittleEndian;
    if (syntax != kDeflated) return elements(0);
    const std::optional<std::string> set = inflated(file_.substr(at_), kMostInflated);
    if (!set) return false;
    file_ = *set;
    at_ = 0;
    return elements(0);
  }

 private:
  // Elements up to the file's end; those of an item up to its delimiter.
  bool elements(int depth) {
    std::uint32_t last_tag = 0;
    while (at_ < file_.size()) {
      Element element;
      if (!readHead(element)) return false;
      if (element.tag == kItemEnd) return depth > 0;
      if (element.tag <= last_tag) return false;  // tags ascend
      last_tag = element.tag;
      if (!value(element, depth)) return false;
    }
    return depth == 0;
  }

  bool value(const Element& element, int depth) {
    if (element.length == kUndefined) return items(file_.size(), true, depth + 1);
    if (element.length > left()) return false;
    if (depth == 0 && !pixelsFit(element)) return false;
    if (element.type == "SQ") return items(at_ + element.length, false, depth + 1);
    at_ += element.length;
    return true;
  }

  // Pixels that are not packed are as many as rows, columns, samples and bits ask for; GDCM takes what is missing for
  // 0. They come last, so the numbers are known then.
  bool pixelsFit(const Element& element) {
    const auto keep = [&](double& number) {
      if (element.length >= 2) number = this->number<std::uint16_t>(at_);
    };
    if (element.tag == kSamples) keep(samples_);
    if (element.tag == kRows) keep(rows_);
    if (element.tag == kColumns) keep(columns_);
    if (element.tag == kBitsAllocated) keep(bits_);
    if (element.tag == kFrames) frames_ = std::atof(std::string(file_.substr(at_, element.length)).c_str());
    if (element.tag != kPixels) return true;
    // There is one frame, one sample and one bit at least, whatever the file says.
    const double values = rows_ * columns_ * std::max(samples_, 1.0) * std::max(frames_, 1.0);
    return static_cast<double>(element.length) * 8 >= values * std::max(bits_, 1.0);
  }

  // Items of a sequence, or fragments of packed pixels, which are items that hold no elements. `delimited`: they end
  // with a delimiter, else at `end`.
  bool items(std::size_t end, bool delimited, int depth) {
    if (depth > kDeepest) return false;
    while (at_ < end) {
      Element item;
      if (!readHead(item)) return false;
      if (item.tag == kSequenceEnd) return delimited || at_ == end;
      if (item.tag != kItem) return false;
      if (item.length == kUndefined) {
        if (!elements(depth)) return false;
      } else {
        if (item.length > left()) return false;
        at_ += item.length;
      }
    }
    return at_ == end && !delimited;
  }

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
      // GDCM guesses at a type that there is not, and may take four bytes of anything for its length.
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
  double rows_ = 0, columns_ = 0, samples_ = 1, frames_ = 1, bits_ = 8;
};

}  // namespace

bool dicomIsWhole(std::string_view file) {
  return file.size() > kPreamble && Walk(file).wholeFile();
}

}  // namespace palpate
