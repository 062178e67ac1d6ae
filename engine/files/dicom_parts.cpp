// SPDX-License-Identifier: Apache-2.0
#include "engine/files/dicom_parts.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace palpate {
namespace {

using Indices = std::vector<std::uint32_t>;

std::uint32_t pointerOf(const DicomItem& dimension) {
  const Indices& parts = dimension.element(DicomTag::kDimensionIndexPointer).numbers;
  return parts.size() == 2 ? parts[0] << 16U | parts[1] : 0;
}

// Whether a dimension counts the places of one stack.
bool countsPlaces(const DicomItem& dimension) {
  constexpr std::uint32_t kInStackPositionNumber = 0x00209057;
  constexpr std::uint32_t kSliceLocation = 0x00201041;
  const std::uint32_t pointer = pointerOf(dimension);
  return pointer == static_cast<std::uint32_t>(DicomTag::kImagePositionPatient) ||
         pointer == static_cast<std::uint32_t>(DicomTag::kPlanePositionSequence) || pointer == kInStackPositionNumber ||
         pointer == kSliceLocation;
}

// As the file calls it; else its tag.
std::string nameOf(const DicomItem& dimension) {
  const std::string label = dimension.text(DicomTag::kDimensionDescriptionLabel);
  const std::uint32_t pointer = pointerOf(dimension);
  return label.empty() ? fmt::format("({:04x},{:04x})", pointer >> 16U, pointer & 0xffffU) : label;
}

const std::vector<DicomItem>& dimensionsOf(const DicomSlice& slice) {
  return slice.file->root.element(DicomTag::kDimensionIndexSequence).items;
}

// The fewest of these dimensions, of the fewest values first, that still tell all slices apart that lie at one place:
// one that counts every frame would tell them all apart, and leave nothing but single slices.
std::vector<std::size_t> fewestOf(std::vector<std::size_t> dimensions, const DicomSeries& slices) {
  std::map<std::size_t, std::set<std::uint32_t>> values;
  for (const DicomSlice& slice : slices)
    for (const std::size_t n : dimensions) values[n].insert(slice.dimensionIndices()[n]);
  std::ranges::stable_sort(dimensions, {}, [&](std::size_t n) { return values[n].size(); });
  const auto tell = [&](std::size_t count) {
    std::set<std::pair<std::string, Indices>> seen;
    for (const DicomSlice& slice : slices) {
      Indices key;
      for (std::size_t i = 0; i < count; ++i) key.push_back(slice.dimensionIndices()[dimensions[i]]);
      if (!seen.emplace(slice.text(DicomTag::kImagePositionPatient), std::move(key)).second) return false;
    }
    return true;
  };
  std::size_t count = 0;
  while (count < dimensions.size() && !tell(count)) ++count;
  dimensions.resize(count);
  std::ranges::sort(dimensions);  // as the file orders them
  return dimensions;
}

// The dimensions in which some slices differ that lie at one place.
std::vector<std::size_t> dividing(const DicomSeries& slices) {
  const std::vector<DicomItem>& dimensions = dimensionsOf(slices[0]);
  std::vector<bool> differs(dimensions.size());
  std::map<std::string, Indices> of_place;
  for (const DicomSlice& slice : slices) {
    const Indices& indices = slice.dimensionIndices();
    if (dimensionsOf(slice).size() != dimensions.size() || indices.size() != dimensions.size()) return {};
    const std::string place = slice.text(DicomTag::kImagePositionPatient);
    if (place.empty()) continue;
    const auto [first, is_new] = of_place.try_emplace(place, indices);
    for (std::size_t n = 0; n < dimensions.size(); ++n)
      if (!is_new && indices[n] != first->second[n] && !countsPlaces(dimensions[n])) differs[n] = true;
  }
  std::vector<std::size_t> found;
  for (std::size_t n = 0; n < differs.size(); ++n)
    if (differs[n]) found.push_back(n);
  return fewestOf(std::move(found), slices);
}

void addDivided(std::vector<DicomSeries>& all, DicomSeries slices, const std::string& words) {
  const std::vector<std::size_t> dimensions = dividing(slices);
  std::map<Indices, DicomSeries> divided;
  for (DicomSlice& slice : slices) {
    Indices key;
    slice.part = words;
    for (const std::size_t n : dimensions) {
      key.push_back(slice.dimensionIndices()[n]);
      slice.part += fmt::format(" {} {}", nameOf(dimensionsOf(slice)[n]), key.back());
    }
    divided[key].push_back(std::move(slice));
  }
  for (auto& [key, part] : divided) all.push_back(std::move(part));
}

}  // namespace

std::vector<DicomSeries> partsOf(DicomSeries slices) {
  std::map<std::pair<std::string, std::uint32_t>, DicomSeries> by_phase;
  for (DicomSlice& slice : slices)
    by_phase[{slice.text(DicomTag::kStackId), slice.phase()}].push_back(std::move(slice));
  std::vector<DicomSeries> parts;
  for (auto& [key, of_phase] : by_phase) {
    const auto& [stack, phase] = key;
    std::string words = stack.empty() ? "" : " stack " + stack;
    if (phase != 0) words += fmt::format(" phase {}", phase);
    addDivided(parts, std::move(of_phase), words);
  }
  return parts;
}

}  // namespace palpate
