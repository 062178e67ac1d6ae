// SPDX-License-Identifier: Apache-2.0
#include "engine/files/dicom_slice.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "base/error.hpp"
#include "engine/files/components.hpp"
#include "engine/files/dicom_structure.hpp"
#include "engine/files/text_header.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

std::string bytesOf(const fs::path& path, const std::string& source) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw cannotRead(source, fmt::format("slice {}", path.filename().string()), {errno, std::generic_category()});
  }
  return {std::istreambuf_iterator<char>(file), {}};
}

constexpr double kFarthest_mm = 1e9;  // no patient lies farther from any origin
constexpr double kUnitLength = 0.01;  // of a direction, from 1; less is a file's rounding

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
std::vector<double> numbersOf(const DicomSlice& slice, const char* key, const char* name, std::size_t count,
                              double most, const std::string& source) {
  std::vector<double> numbers = dicomNumbers(slice.tag(key));
  const bool good = std::all_of(numbers.begin(), numbers.end(), [&](double n) { return std::abs(n) <= most; });
  if (good && numbers.size() == count) return numbers;
  refuse(source,
         fmt::format("the {} \"{}\" of slice {} is not {}", name, slice.tag(key), slice.name(),
                     count == 1 ? "a finite number" : fmt::format("{} finite numbers", count)),
         "copy the series again");
}

// Refuses a slope or intercept that is not a usable number: GDCM would ignore it, or all densities would be the same.
void checkScale(const DicomSlice& slice, const std::string& source) {
  for (const auto& [key, name] : {std::pair("0028|1053", "RescaleSlope"), std::pair("0028|1052", "RescaleIntercept")}) {
    const std::string text = slice.tag(key);
    if (text.empty()) continue;
    const std::vector<double> numbers = dicomNumbers(text);
    const bool good = numbers.size() == 1 && std::isfinite(numbers[0]);
    if (good && (numbers[0] != 0 || key == std::string_view("0028|1052"))) continue;
    refuse(source, fmt::format("the {} \"{}\" of slice {} is no number to scale by", name, text, slice.name()),
           "copy the series again");
  }
}

void placeSlice(DicomSlice& slice, const std::string& source) {
  const std::vector<double> spacing = dicomNumbers(slice.tag("0028|0030"));
  if (spacing.size() != 2 || !(spacing[0] > 0) || !(spacing[1] > 0)) {
    refuse(source,
           fmt::format("the PixelSpacing \"{}\" of slice {} is not positive", slice.tag("0028|0030"), slice.name()),
           "write the true pixel size into the files");
  }
  slice.spacing_mm = {spacing[1], spacing[0]};  // the file has the distance between rows first
  if (slice.tag("0020|0032").empty() || slice.tag("0020|0037").empty()) {
    refuse(source, fmt::format("slice {} has no position or orientation", slice.name()), "give a CT or MR series");
  }
  const std::vector<double> position = numbersOf(slice, "0020|0032", "ImagePositionPatient", 3, kFarthest_mm, source);
  slice.position_mm = Vec3(position[0], position[1], position[2]);
  const std::vector<double> directions = numbersOf(slice, "0020|0037", "ImageOrientationPatient", 6, 2, source);
  for (std::size_t n = 0; n < 2; ++n) {
    const Vec3 axis(directions[3 * n], directions[3 * n + 1], directions[3 * n + 2]);
    if (std::abs(axis.norm() - 1) > kUnitLength) {
      refuse(source,
             fmt::format("the ImageOrientationPatient \"{}\" of slice {} is not two unit vectors",
                         slice.tag("0020|0037"), slice.name()),
             "copy the series again");
    }
    slice.axes[n] = axis.normalized();
  }
  // The spacing of slices follows from their positions. But a file whose own figure for it is invalid is damaged.
  if (slice.tag("0018|0088").empty()) return;
  static_cast<void>(numbersOf(slice, "0018|0088", "SpacingBetweenSlices", 1, kFarthest_mm, source));
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

bool isDicomSlice(const fs::path& path, const std::string& source) {
  const std::string bytes = bytesOf(path, source);
  if (dicomIsNoImage(bytes)) return false;
  if (dicomIsWhole(bytes)) return true;
  refuse(source, fmt::format("slice {} is cut short or damaged", path.filename().string()), "copy the series again");
}

void checkDicomSlice(DicomSlice& slice, const std::string& source) {
  const ItkHeader& header = slice.file.header;
  if (header.components != 1) {
    refuseComponents(source, Components::kColours, header.components,
                     fmt::format("the pixels of slice {}", slice.name()));
  }
  if (!header.type) {
    refuse(source, fmt::format("the pixels of slice {} are no numbers", slice.name()), "give a CT or MR series");
  }
  if (header.dimensions.size() > 2 && header.dimensions[2] > 1) {
    refuse(source, fmt::format("{} holds several frames", slice.name()), "convert it to NIfTI or NRRD");
  }
  checkScale(slice, source);
  placeSlice(slice, source);
}

RefuseFile refuseSlice(const std::vector<fs::path>& files, const std::string& source) {
  return [&files, &source](std::size_t n, const std::string& words) {
    refuse(source, fmt::format("slice {} is damaged ({})", files[n].filename().string(), words),
           "copy the series again");
  };
}

}  // namespace palpate
