// SPDX-License-Identifier: Apache-2.0
#include "engine/files/dicom_slice.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "base/error.hpp"
#include "engine/field/memory_budget.hpp"
#include "engine/files/dicom_structure.hpp"
#include "engine/files/text_header.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr double kFarthest_mm = 1e9;  // no patient lies farther from any origin
constexpr double kUnitLength = 0.01;  // of a direction, from 1; less is a file's rounding
constexpr std::size_t kMostFramesOfFile = std::size_t{64} * kMaxDimension;  // of a file: 64 of the highest volumes

double decimalOf(std::string_view word) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  while (!word.empty() && word.front() == ' ') word.remove_prefix(1);
  while (!word.empty() && (word.back() == ' ' || word.back() == '\0')) word.remove_suffix(1);
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
  double number = 0;
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), number);
  return code == std::errc() && end == word.data() + word.size() && std::isfinite(number) ? number : kNone;
}

// Exactly `count` finite numbers of magnitude `most` at most; otherwise throws.
std::vector<double> numbersOf(const DicomSlice& slice, DicomTag tag, const char* name, std::size_t count, double most,
                              const std::string& source) {
  std::vector<double> numbers = dicomNumbers(slice.text(tag));
  const bool good = std::all_of(numbers.begin(), numbers.end(), [&](double n) { return std::abs(n) <= most; });
  if (good && numbers.size() == count) return numbers;
  refuse(source,
         fmt::format("the {} \"{}\" of {} is not {}", name, slice.text(tag), slice.name(),
                     count == 1 ? "a finite number" : fmt::format("{} finite numbers", count)),
         "copy the series again");
}

// The sequence in which a file of functional groups keeps an element.
std::optional<DicomTag> groupOf(DicomTag tag) {
  switch (tag) {
    case DicomTag::kImagePositionPatient:
      return DicomTag::kPlanePositionSequence;
    case DicomTag::kImageOrientationPatient:
      return DicomTag::kPlaneOrientationSequence;
    case DicomTag::kPixelSpacing:
    case DicomTag::kSpacingBetweenSlices:
      return DicomTag::kPixelMeasuresSequence;
    case DicomTag::kRescaleSlope:
    case DicomTag::kRescaleIntercept:
      return DicomTag::kPixelValueTransformationSequence;
    case DicomTag::kStackId:
    case DicomTag::kTemporalPositionIndex:
    case DicomTag::kDimensionIndexValues:
      return DicomTag::kFrameContentSequence;
    default:
      return {};
  }
}

// Where a slice has an element: the frame's own group, the shared one, or the file.
const DicomItem& ownerOf(const DicomSlice& slice, DicomTag tag) {
  const DicomItem& root = slice.file->root;
  const std::optional<DicomTag> group = groupOf(tag);
  if (!group) return root;
  const auto& frames = root.element(DicomTag::kPerFrameFunctionalGroupsSequence).items;
  const DicomItem* const own = slice.frame < frames.size() ? &frames[slice.frame] : nullptr;
  for (const DicomItem* of : {own, root.item(DicomTag::kSharedFunctionalGroupsSequence)}) {
    const DicomItem* found = of == nullptr ? nullptr : of->item(*group);
    if (found != nullptr && found->has(tag)) return *found;
  }
  return root;
}

std::size_t describedFrames(const DicomDataSet& set) {
  return set.root.element(DicomTag::kPerFrameFunctionalGroupsSequence).items.size();
}

// An object of a class that nobody knows, such as a maker's own. What has a size or a place is a slice that lost its
// pixels.
bool isNoImage(const DicomItem& root) {
  return !root.has(DicomTag::kRows) && !root.has(DicomTag::kColumns) && !root.has(DicomTag::kImagePositionPatient);
}

// Before there is a DicomSlice for every frame.
void checkSize(const DicomSlice& slice, const std::string& source) {
  if (slice.rows() == 0 || slice.columns() == 0) {
    refuse(source, fmt::format("{} has {} rows of {} columns", slice.name(), slice.rows(), slice.columns()),
           "copy the series again or take the file away");
  }
  if (slice.file->frames <= kMostFramesOfFile) return;
  refuse(source, fmt::format("{} holds more than {} frames", slice.path.filename().string(), kMostFramesOfFile),
         "split it in another program");
}

void checkFrames(const DicomSlice& slice, const std::string& source) {
  const std::size_t described = describedFrames(*slice.file);
  if (slice.frames == 1 || described == slice.frames) return;
  const std::string holds = fmt::format("{} holds {} frames", slice.path.filename().string(), slice.frames);
  refuse(source,
         described == 0 ? holds + " and does not say where each lies"
                        : fmt::format("{} and describes {}", holds, described),
         "convert it to NIfTI or NRRD");
}

}  // namespace

std::vector<double> dicomNumbers(const std::string& text) {
  std::vector<double> numbers;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\\', begin), text.size());
    numbers.push_back(decimalOf(std::string_view(text).substr(begin, end - begin)));
    begin = end + 1;
  }
  return numbers;
}

std::size_t DicomSlice::columns() const {
  return file->root.number(DicomTag::kColumns, 0);
}

std::size_t DicomSlice::rows() const {
  return file->root.number(DicomTag::kRows, 0);
}

std::string DicomSlice::shortName() const {
  const std::string file_name = path.filename().string();
  return frames == 1 ? file_name : fmt::format("frame {} of {}", frame + 1, file_name);
}

std::string DicomSlice::name() const {
  return frames == 1 ? "slice " + shortName() : shortName();
}

std::string DicomSlice::text(DicomTag tag) const {
  return ownerOf(*this, tag).text(tag);
}

std::uint32_t DicomSlice::phase() const {
  constexpr DicomTag kPhase = DicomTag::kTemporalPositionIndex;
  return ownerOf(*this, kPhase).number(kPhase, 0);
}

const std::vector<std::uint32_t>& DicomSlice::dimensionIndices() const {
  constexpr DicomTag kIndices = DicomTag::kDimensionIndexValues;
  return ownerOf(*this, kIndices).element(kIndices).numbers;
}

std::string bytesOfSlice(const fs::path& path, const std::string& source) {
  const auto cannot = [&] {
    return cannotRead(source, "slice " + path.filename().string(), {errno, std::generic_category()});
  };
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) throw cannot();
  std::string bytes(static_cast<std::size_t>(std::max<std::streamoff>(0, file.tellg())), '\0');
  file.seekg(0);
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (file.bad()) throw cannot();
  bytes.resize(static_cast<std::size_t>(file.gcount()));  // of a file that somebody made shorter in between
  return bytes;
}

DicomSeries slicesOfFile(const fs::path& path, const std::string& source) {
  const std::string bytes = bytesOfSlice(path, source);
  if (dicomIsNoImage(bytes)) return {};
  std::optional<DicomDataSet> set = readDicomDataSet(bytes);
  DicomSlice slice;
  slice.path = path;
  if (!set) refuse(source, fmt::format("{} is cut short or damaged", slice.name()), "copy the series again");
  if (!set->has_pixels && !set->floating) {
    if (isNoImage(set->root)) return {};
    refuse(source, fmt::format("{} has no pixels", slice.name()), "copy the series again or take the file away");
  }
  slice.file = std::make_shared<const DicomDataSet>(*std::move(set));
  checkSize(slice, source);
  slice.frames = slice.file->frames;
  // Of frames that are not described nobody knows where they lie: placeSlice refuses them.
  if (describedFrames(*slice.file) != slice.frames) return {slice};
  DicomSeries slices(slice.frames, slice);
  for (std::size_t n = 0; n < slices.size(); ++n) slices[n].frame = n;
  return slices;
}

void placeSlice(DicomSlice& slice, const std::string& source) {
  checkFrames(slice, source);
  const std::vector<double> spacing = dicomNumbers(slice.text(DicomTag::kPixelSpacing));
  if (spacing.size() != 2 || !(spacing[0] > 0) || !(spacing[1] > 0)) {
    refuse(
        source,
        fmt::format("the PixelSpacing \"{}\" of {} is not positive", slice.text(DicomTag::kPixelSpacing), slice.name()),
        "write the true pixel size into the files");
  }
  slice.spacing_mm = {spacing[1], spacing[0]};  // the file has the distance between rows first
  if (slice.text(DicomTag::kImagePositionPatient).empty() || slice.text(DicomTag::kImageOrientationPatient).empty()) {
    refuse(source, fmt::format("{} has no position or orientation", slice.name()), "give a CT or MR series");
  }
  const std::vector<double> position =
      numbersOf(slice, DicomTag::kImagePositionPatient, "ImagePositionPatient", 3, kFarthest_mm, source);
  slice.position_mm = Vec3(position[0], position[1], position[2]);
  const std::vector<double> directions =
      numbersOf(slice, DicomTag::kImageOrientationPatient, "ImageOrientationPatient", 6, 2, source);
  for (std::size_t n = 0; n < 2; ++n) {
    const Vec3 axis(directions[3 * n], directions[3 * n + 1], directions[3 * n + 2]);
    if (std::abs(axis.norm() - 1) > kUnitLength) {
      refuse(source,
             fmt::format("the ImageOrientationPatient \"{}\" of {} is not two unit vectors",
                         slice.text(DicomTag::kImageOrientationPatient), slice.name()),
             "copy the series again");
    }
    slice.axes[n] = axis.normalized();
  }
  // The spacing of slices follows from their positions. But a file whose own figure for it is invalid is damaged.
  if (slice.text(DicomTag::kSpacingBetweenSlices).empty()) return;
  static_cast<void>(numbersOf(slice, DicomTag::kSpacingBetweenSlices, "SpacingBetweenSlices", 1, kFarthest_mm, source));
}

}  // namespace palpate
