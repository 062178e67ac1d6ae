// SPDX-License-Identifier: Apache-2.0
// A folder of DICOM slices: "folder". If it holds several series, one must be named: "folder#2" by its number in the
// order of UIDs, "folder#1.2.3" by its UID.
//
// GDCM under ITK, in a child process (itk_child.hpp), reads each slice and applies its slope and intercept.
#include <algorithm>
#include <filesystem>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "base/shared_buffer.hpp"
#include "engine/field/memory_budget.hpp"
#include "engine/field/raw_values.hpp"
#include "engine/files/dicom_folder.hpp"
#include "engine/files/dicom_geometry.hpp"
#include "engine/files/readers.hpp"
#include "engine/files/volume_name.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

std::vector<float> readPixels(const DicomSeries& series, const std::string& source) {
  const auto& n = series[0].file.header.dimensions;
  const auto pixels = static_cast<std::size_t>(n[0] * n[1]);
  std::vector<fs::path> files;
  std::vector<std::string> paths;
  std::size_t bytes = 0;
  for (const DicomSlice& slice : series) {
    files.push_back(slice.path);
    paths.push_back(slice.path.string());
    bytes += pixels * byteSize(*slice.file.header.type);
  }
  const SharedBuffer raw(bytes);
  std::vector<std::span<char>> parts;
  std::size_t at = 0;
  for (const DicomSlice& slice : series) {
    parts.push_back(raw.bytes().subspan(at, pixels * byteSize(*slice.file.header.type)));
    at += parts.back().size();
  }
  readItkSeriesValues(ItkReader::kDicomSlice, paths, parts, source, refuseSlice(files, source));
  std::vector<float> values;
  values.reserve(pixels * series.size());
  for (std::size_t slice = 0; slice < series.size(); ++slice) {
    const std::vector<float> converted = toFloats(parts[slice], *series[slice].file.header.type);
    values.insert(values.end(), converted.begin(), converted.end());
  }
  return values;
}

// The lowest and the highest value of a number that slices may give.
std::pair<double, double> rangeOf(const DicomSeries& series, const char* key, double otherwise) {
  std::vector<double> all;
  for (const DicomSlice& slice : series) {
    const std::vector<double> numbers = dicomNumbers(slice.tag(key));
    all.push_back(numbers.empty() ? otherwise : numbers[0]);
  }
  const auto [low, high] = std::minmax_element(all.begin(), all.end());
  return {*low, *high};
}

std::string inWords(const std::pair<double, double>& range) {
  if (range.first == range.second) return fmt::format("{:g}", range.first);
  return fmt::format("{:g} to {:g}", range.first, range.second);
}

void tellRescale(const DicomSeries& series, VolumeFacts& facts) {
  const auto slope = rangeOf(series, "0028|1053", 1);
  const auto intercept = rangeOf(series, "0028|1052", 0);
  if (slope.first == slope.second && intercept.first == intercept.second) {
    facts.rescale_slope = slope.first;
    facts.rescale_intercept = intercept.first;
  } else {
    facts.rescale_by_slice = fmt::format("slope {}, intercept {}", inWords(slope), inWords(intercept));
  }
}

VolumeFacts factsOf(const DicomFolder& all, const std::string& uid, const std::string& source) {
  const DicomSlice& first = all.at(uid)[0];
  VolumeFacts facts;
  facts.source = source;
  facts.format = "DICOM series";
  const std::vector<double> stored_bits = dicomNumbers(first.tag("0028|0100"));
  const std::vector<double> is_signed = dicomNumbers(first.tag("0028|0103"));
  facts.value_type = fmt::format("{}int{:.0f}", is_signed == std::vector<double>{1} ? "" : "u",
                                 stored_bits.empty() ? 16 : stored_bits[0]);
  facts.orientation = "LPS, from the slices' positions";
  tellRescale(all.at(uid), facts);
  const std::string description = first.tag("0008|103e");
  const std::string words = description.empty() ? uid : fmt::format("{} \"{}\"", uid, description);
  facts.part = all.size() == 1 ? "series " + words
                               : fmt::format("series {} of {}: {}", std::distance(all.begin(), all.find(uid)) + 1,
                                             all.size(), words);
  return facts;
}

}  // namespace

Volume readDicom(const ReadRequest& wanted) {
  const std::string& name = wanted.name;
  const VolumeName parsed = parseVolumeName(name);
  DicomFolder all = readDicomFolder(parsed.path, name);
  const std::string uid = chooseSeries(all, parsed.part, name);
  DicomSeries& series = all.at(uid);
  const Lattice lattice = placeSlices(series, name);
  const auto& n = series[0].file.header.dimensions;
  const auto count = static_cast<std::int64_t>(series.size());
  checkMemory(name, n[0], n[1], count, 0, wanted.memory_budget_bytes);
  const Vec3i size(static_cast<int>(n[0]), static_cast<int>(n[1]), static_cast<int>(count));
  VolumeFacts facts = factsOf(all, uid, name);
  facts.instead_of_nan = wanted.instead_of_nan;
  return Volume::fromDense(size, lattice, readPixels(series, name), std::move(facts));
}

}  // namespace palpate
