// SPDX-License-Identifier: Apache-2.0
#include "engine/files/dicom_pixels.hpp"

#include <algorithm>
#include <cerrno>
#include <map>
#include <memory>
#include <optional>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "base/descriptor.hpp"
#include "base/error.hpp"
#include "base/shared_buffer.hpp"
#include "engine/field/raw_values.hpp"
#include "engine/files/dicom_rle.hpp"
#include "engine/files/dicom_structure.hpp"
#include "engine/files/gdcm_child.hpp"
#include "engine/files/text_header.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

std::size_t frameBytes(const DicomSlice& slice, const DicomValueRule& rule) {
  return slice.columns() * slice.rows() * rule.wordBytes();
}

void checkPixels(const DicomSlice& slice, const DicomValueRule& rule, const std::string& source) {
  const DicomDataSet& file = *slice.file;
  if (dicomIsPlain(file.syntax) == file.packed) {
    refuse(source,
           fmt::format("the pixels of {} are {}, which its transfer syntax {} does not say", slice.name(),
                       file.packed ? "packed" : "plain bytes", file.syntax),
           "copy the series again");
  }
  // Writers disagree about which of two pixels in a word comes first (PS3.5, 7.3).
  if (!file.packed && file.swapped && rule.bits_allocated == 8 && file.pixel_type == "OW") {
    refuse(source, fmt::format("{} holds two pixels in a word, in big-endian order", slice.name()),
           "convert the series to little-endian order");
  }
  if (file.unpackedByGdcm() && !gdcmUnpacks(file.syntax)) {
    refuse(source, fmt::format("{} is packed as {}, which Palpate does not read", slice.name(), file.syntax),
           "unpack the series in another program");
  }
  if (file.unpackedByGdcm() && rule.high_bit + 1 != rule.bits_stored) {
    refuse(source,
           fmt::format("{} is packed, and the highest of its {} bits (BitsStored) is bit {} (HighBit)", slice.name(),
                       rule.bits_stored, rule.high_bit),
           "unpack the series in another program");
  }
  if (file.unpackedByGdcm() && rule.bits_allocated == 8 && rule.bits_stored < 8) {  // an assertion of GDCM's
    refuse(source,
           fmt::format("{} is packed, and has {} bits (BitsStored) in pixels of 8", slice.name(), rule.bits_stored),
           "unpack the series in another program");
  }
}

ValueType wordType(const DicomValueRule& rule) {
  if (rule.bits_allocated == 8) return ValueType::kUint8;
  return rule.bits_allocated == 16 ? ValueType::kUint16 : ValueType::kUint32;
}

// Pixels that are plain bytes or packed as RLE. Keeps the file of the last slice, for the next of its frames.
class OwnPixels {
 public:
  explicit OwnPixels(const std::string& source) : source_(source) {}

  [[nodiscard]] std::vector<char> words(const DicomSlice& slice, const DicomValueRule& rule) {
    if (slice.path != path_) open(slice);
    std::vector<char> words(frameBytes(slice, rule));
    if (slice.file->packed) {
      const DicomDataSet::Fragment& frame = slice.file->rle_frames.at(slice.frame);
      std::vector<char> packed(frame.bytes);
      read(slice, frame.offset, packed);
      if (!unpackRle({packed.data(), packed.size()}, rule.wordBytes(), words)) refuseChanged(slice);
      return words;
    }
    const std::uint64_t begin = slice.file->pixel_offset + slice.frame * words.size();
    slice.file->deflated ? copy(slice, begin, words) : read(slice, begin, words);
    if (slice.file->swapped) swapBytes(words, wordType(rule));
    return words;
  }

 private:
  void open(const DicomSlice& slice) {
    path_ = slice.path;
    if (slice.file->deflated) {
      auto set = inflatedDicom(bytesOfSlice(slice.path, source_));
      if (!set) refuseChanged(slice);
      inflated_ = *std::move(set);
    } else {
      opened_ = Descriptor(::open(slice.path.c_str(), O_RDONLY | O_CLOEXEC));
      if (!opened_) throw cannotRead(source_, slice.name(), {errno, std::generic_category()});
    }
  }

  void copy(const DicomSlice& slice, std::uint64_t begin, std::vector<char>& words) const {
    if (begin > inflated_.size() || words.size() > inflated_.size() - begin) refuseChanged(slice);
    inflated_.copy(words.data(), words.size(), begin);
  }

  void read(const DicomSlice& slice, std::uint64_t begin, std::vector<char>& words) const {
    for (std::size_t done = 0; done < words.size();) {
      const ssize_t got =
          pread(opened_.get(), words.data() + done, words.size() - done, static_cast<off_t>(begin + done));
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) throw cannotRead(source_, slice.name(), {errno, std::generic_category()});
      if (got == 0) refuseChanged(slice);
      done += static_cast<std::size_t>(got);
    }
  }

  [[noreturn]] void refuseChanged(const DicomSlice& slice) const {
    refuse(source_, fmt::format("{} changed while it was read", slice.name()), "copy the series again");
  }

  const std::string& source_;
  fs::path path_;
  Descriptor opened_;
  std::string inflated_;
};

// The words of files that GDCM unpacks, all of whose frames are unpacked at once.
class PackedPixels {
 public:
  PackedPixels(const DicomSeries& series, const std::vector<DicomValueRule>& rules, const std::string& source)
      : source_(source) {
    std::size_t bytes = 0;
    for (std::size_t n = 0; n < series.size(); ++n) {
      if (!series[n].file->unpackedByGdcm() || !begins_.emplace(series[n].path, bytes).second) continue;
      files_.push_back({series[n].path, rules[n].bits_allocated, {}});
      sizes_.push_back(series[n].frames * frameBytes(series[n], rules[n]));
      bytes += sizes_.back();
    }
    if (files_.empty()) return;
    words_.emplace(bytes);
    for (std::size_t n = 0; n < files_.size(); ++n)
      files_[n].words = words_->bytes().subspan(begins_.at(files_[n].path), sizes_[n]);
    unpackDicom(files_, source);
  }

  [[nodiscard]] std::span<const char> words(const DicomSlice& slice, const DicomValueRule& rule) {
    const std::size_t bytes = frameBytes(slice, rule);
    const std::span<char> words = words_->bytes().subspan(begins_.at(slice.path) + slice.frame * bytes, bytes);
    if (dicomIsLossy(slice.file->syntax)) {
      clamped_ += clampToStored(rule, words);
      return words;
    }
    if (!hasOtherBits(rule, words)) return words;
    refuse(source_,
           fmt::format("the packed pixels of {} have more bits than BitsStored, {}", slice.name(), rule.bits_stored),
           "unpack the series in another program");
  }
  [[nodiscard]] std::size_t clamped() const { return clamped_; }

 private:
  const std::string& source_;
  std::size_t clamped_ = 0;
  std::map<fs::path, std::size_t> begins_;
  std::vector<PackedFile> files_;
  std::vector<std::size_t> sizes_;
  std::optional<SharedBuffer> words_;
};

}  // namespace

DicomPixels readDicomPixels(const DicomSeries& series, const std::vector<DicomValueRule>& rules,
                            const std::string& source) {
  for (std::size_t n = 0; n < series.size(); ++n) checkPixels(series[n], rules[n], source);
  PackedPixels packed(series, rules, source);
  OwnPixels own(source);
  const std::size_t each = series[0].columns() * series[0].rows();
  DicomPixels pixels;
  pixels.densities.resize(each * series.size());
  if (std::any_of(rules.begin(), rules.end(), [](const DicomValueRule& rule) { return rule.padding.has_value(); }))
    pixels.padding.resize(pixels.densities.size());
  for (std::size_t n = 0; n < series.size(); ++n) {
    const auto take = [&](std::span<const char> words) {
      toDensities(rules[n], words, std::span(pixels.densities).subspan(n * each, each), pixels.rounded);
      markPadding(rules[n], words, pixels.padding, n * each);
    };
    if (series[n].file->unpackedByGdcm()) {
      take(packed.words(series[n], rules[n]));
    } else {
      take(own.words(series[n], rules[n]));
    }
  }
  pixels.clamped = packed.clamped();
  return pixels;
}

}  // namespace palpate
