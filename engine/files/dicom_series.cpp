// SPDX-License-Identifier: Apache-2.0
// A folder of DICOM slices: "folder". If it holds several series, one must be named: "folder#2" by its number in the
// order of UIDs, "folder#1.2.3" by its UID. A series is many files of one slice, or files of many frames.
#include <algorithm>
#include <filesystem>
#include <iterator>
#include <limits>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "base/error.hpp"
#include "base/units.hpp"
#include "engine/field/memory_budget.hpp"
#include "engine/files/dicom_folder.hpp"
#include "engine/files/dicom_geometry.hpp"
#include "engine/files/dicom_padding.hpp"
#include "engine/files/dicom_pixels.hpp"
#include "engine/files/dicom_upright.hpp"
#include "engine/files/dicom_values.hpp"
#include "engine/files/readers.hpp"
#include "engine/files/volume_name.hpp"

namespace palpate {
namespace {

using Rules = std::vector<DicomValueRule>;

// The lowest and the highest of a number that each slice has, in words: "0.5 to 4".
std::string rangeOf(const Rules& rules, double DicomValueRule::*number) {
  const auto [low, high] = std::minmax_element(rules.begin(), rules.end(),
                                               [&](const auto& a, const auto& b) { return a.*number < b.*number; });
  if ((*low).*number == (*high).*number) return fmt::format("{:g}", (*low).*number);
  return fmt::format("{:g} to {:g}", (*low).*number, (*high).*number);
}

void tellRescale(const Rules& rules, VolumeFacts& facts) {
  const bool alike = std::all_of(rules.begin(), rules.end(), [&](const DicomValueRule& rule) {
    return rule.slope == rules[0].slope && rule.intercept == rules[0].intercept;
  });
  if (rules[0].table) {
    facts.rescale_in_words = "what the table ModalityLUTSequence gives for the stored value";
  } else if (alike) {
    facts.rescale_slope = rules[0].slope;
    facts.rescale_intercept = rules[0].intercept;
  } else {
    facts.rescale_in_words =
        fmt::format("slope * stored + intercept, by slice: slope {}, intercept {}",
                    rangeOf(rules, &DicomValueRule::slope), rangeOf(rules, &DicomValueRule::intercept));
  }
}

VolumeFacts factsOf(const DicomFolder& all, const std::string& key, const Rules& rules, const std::string& source) {
  VolumeFacts facts;
  facts.source = source;
  facts.format = "DICOM series";
  facts.value_type = fmt::format("{}int{}", rules[0].is_signed ? "" : "u", rules[0].bits_allocated);
  facts.orientation = "LPS, from the slices' positions";
  tellRescale(rules, facts);
  const std::string words = wordsOfSeries(all, key, false);
  facts.part = all.size() == 1 ? "series " + words
                               : fmt::format("series {} of {}: {}", std::distance(all.begin(), all.find(key)) + 1,
                                             all.size(), words);
  return facts;
}

// The words of packed files that are held while they are read, for each voxel [byte].
double packedBytesPerVoxel(const DicomSeries& series) {
  double bytes = 0;
  std::set<const DicomDataSet*> counted;
  for (const DicomSlice& slice : series) {
    if (!slice.file->unpackedByGdcm() || !counted.insert(slice.file.get()).second) continue;
    const double word_bytes = slice.file->root.number(DicomTag::kBitsAllocated, 0) / 8.0;
    bytes += static_cast<double>(slice.frames) * word_bytes;
  }
  return bytes / static_cast<double>(series.size());
}

void addRemark(VolumeFacts& facts, const std::string& words) {
  facts.remark += (facts.remark.empty() ? "" : "; ") + words;
}

std::ptrdiff_t countWithout(const std::vector<float>& values) {
  return std::count_if(values.begin(), values.end(), isNoValue);
}

// The density of voxels without a value: what the user named, else the lowest of the others.
float valueInstead(const std::vector<float>& values, const VolumeFacts& facts) {
  if (facts.instead_of_nan) return *facts.instead_of_nan;
  float lowest = std::numeric_limits<float>::max();
  for (const float value : values)
    if (value < lowest) lowest = value;
  return lowest;
}

void tellPadding(const SettledPadding& padding, std::size_t pixels, VolumeFacts& facts) {
  if (padding.padded == 0) return;
  std::string words = fmt::format("{} of {} pixels are padding in the files", padding.padded, pixels);
  if (padding.kept == padding.padded) {
    words += " and keep their densities (--nan gives another)";
  } else if (padding.kept > 0) {
    words += fmt::format("; {} of these keep their densities, which no other is below", padding.kept);
  }
  addRemark(facts, words);
}

void tellScaleInPart(const DicomValueRule& rule, VolumeFacts& facts) {
  if (rule.has_slope == rule.has_intercept) return;
  addRemark(facts, rule.has_slope ? "its files have a RescaleSlope and no RescaleIntercept, which is taken as 0"
                                  : "its files have a RescaleIntercept and no RescaleSlope, which is taken as 1");
}

// Replaces voxels without a value, and tells how many they are.
void fillIn(std::vector<float>& values, VolumeFacts& facts) {
  const std::ptrdiff_t without = countWithout(values);
  if (without == std::ssize(values)) {
    refuse(facts.source, "no voxel of the upright volume lies between pixels that are not padding",
           "give another series");
  }
  if (without == 0) return;
  facts.replaced = static_cast<std::uint64_t>(without);
  const float instead = valueInstead(values, facts);
  std::replace_if(values.begin(), values.end(), isNoValue, instead);
  addRemark(facts, fmt::format("{} of {} voxels have no value and are {} here{}", without, values.size(), instead,
                               facts.instead_of_nan ? "" : ", the lowest density (--nan gives another)"));
}

}  // namespace

Volume readDicom(const ReadRequest& wanted) {
  const std::string& name = wanted.name;
  const VolumeName parsed = parseVolumeName(name);
  DicomFolder all = readDicomFolder(parsed.path, name);
  const std::string key = chooseSeries(all, parsed.part, name);
  DicomSeries& series = all.at(key);
  const DicomBlock block = placeSlices(series, name, wanted.resample);
  const auto count = static_cast<std::int64_t>(series.size());
  UprightBlock upright{block.lattice, static_cast<std::int64_t>(series[0].columns()),
                       static_cast<std::int64_t>(series[0].rows())};
  if (block.tilt > 0) upright = uprightBlockOf(series, block.lattice);
  checkMemory(name, upright.columns, upright.rows, count,
              packedBytesPerVoxel(series) + (block.tilt > 0 ? kDenseBytesPerVoxel : 0), wanted.memory_budget_bytes);
  const Rules rules = valueRulesOf(series, name);
  VolumeFacts facts = factsOf(all, key, rules, name);
  facts.instead_of_nan = wanted.instead_of_nan;
  DicomPixels pixels = readDicomPixels(series, rules, name);
  const bool scaled = std::any_of(rules.begin(), rules.end(),
                                  [](const DicomValueRule& rule) { return rule.slope != 1 || rule.intercept != 0; });
  RoundedNumbers rounded;
  rounded.add(pixels.rounded);
  facts.rounded = rounded.of(facts.value_type, scaled);
  std::vector<float>& values = pixels.densities;
  tellScaleInPart(rules[0], facts);
  facts.clamped = pixels.clamped;
  if (pixels.clamped > 0)
    addRemark(facts, fmt::format("{} of {} pixels, packed with losses, lay beyond BitsStored and were held within it",
                                 pixels.clamped, values.size()));
  tellPadding(settlePadding(values, pixels.padding, !facts.instead_of_nan, name), values.size(), facts);
  if (block.tilt > 0) {
    values = resampledUpright(values, series, upright);
    facts.resampled = true;
    addRemark(facts, fmt::format("its slices are tilted by {:.3g} degrees and were resampled upright",
                                 block.tilt * kDegreesPerRadian));
  }
  fillIn(values, facts);
  const Vec3i size(static_cast<int>(upright.columns), static_cast<int>(upright.rows), static_cast<int>(count));
  return Volume::fromDense(size, upright.lattice, values, std::move(facts));
}

}  // namespace palpate
