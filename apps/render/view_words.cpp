// SPDX-License-Identifier: Apache-2.0
#include "apps/render/view_words.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "apps/scene/option_value.hpp"

namespace palpate {
namespace {

struct NamedView {
  const char* name;
  double azimuth_deg, elevation_deg;
};

// Straight from above, the azimuth says which side is up in the picture: the one away from it.
constexpr NamedView kViews[] = {{"front", 0, 0},   {"back", 180, 0}, {"left", 90, 0},
                                {"right", -90, 0}, {"top", 180, 90}, {"bottom", 0, -90}};

ViewAngles angles(double azimuth_deg, double elevation_deg) {
  return {azimuth_deg / kDegreesPerRadian, elevation_deg / kDegreesPerRadian};
}

std::optional<std::pair<double, double>> pairOf(std::string_view text) {
  const std::size_t comma = text.find(',');
  if (comma == std::string_view::npos) return std::nullopt;
  const auto first = numberOf(text.substr(0, comma)), second = numberOf(text.substr(comma + 1));
  if (!first || !second || !std::isfinite(*first) || !std::isfinite(*second)) return std::nullopt;
  return std::pair(*first, *second);
}

std::optional<double> placeOf(std::string_view text) {
  const auto place_mm = numberOf(text);
  if (!place_mm || !(std::abs(*place_mm) <= kFarthest_mm)) return std::nullopt;
  return *place_mm * kMetresPerMillimetre;
}

std::optional<int> sideOf(std::string_view text) {
  int side = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), side);
  if (error != std::errc{} || end != text.data() + text.size() || side < 1) return std::nullopt;
  return side;
}

}  // namespace

std::vector<std::string> viewNames() {
  std::vector<std::string> names;
  for (const NamedView& view : kViews) names.emplace_back(view.name);
  return names;
}

std::optional<ViewAngles> viewNamed(std::string_view name) {
  const auto* found = std::find_if(std::begin(kViews), std::end(kViews), [&](const auto& v) { return name == v.name; });
  if (found == std::end(kViews)) return std::nullopt;
  return angles(found->azimuth_deg, found->elevation_deg);
}

std::optional<ViewAngles> viewAnglesOf(std::string_view text) {
  const auto degrees = pairOf(text);
  if (!degrees || std::abs(degrees->first) > 360 || std::abs(degrees->second) > 90) return std::nullopt;
  return angles(degrees->first, degrees->second);
}

std::optional<ViewPlane> planeOf(std::string_view text) {
  if (const std::size_t at = text.find('@'); at != std::string_view::npos) {
    const auto normal = vectorOf(text.substr(0, at));
    const auto place_m = placeOf(text.substr(at + 1));
    if (!normal || normal->isZero(0) || !place_m) return std::nullopt;
    return ViewPlane{normal->stableNormalized(), *place_m};
  }
  const double sign = text.starts_with('-') ? -1 : 1;
  if (sign < 0) text.remove_prefix(1);
  if (text.size() < 3 || text[0] < 'x' || text[0] > 'z' || text[1] != '=') return std::nullopt;
  const auto place_m = placeOf(text.substr(2));
  if (!place_m) return std::nullopt;
  return ViewPlane{sign * Vec3::Unit(text[0] - 'x'), sign * *place_m};
}

std::optional<PictureSize> pictureSizeOf(std::string_view text) {
  const std::size_t x = text.find('x');
  if (x == std::string_view::npos) return std::nullopt;
  const auto width = sideOf(text.substr(0, x)), height = sideOf(text.substr(x + 1));
  if (!width || !height) return std::nullopt;
  return PictureSize{*width, *height};
}

std::optional<SliceRange> sliceRangeOf(std::string_view text) {
  const auto range = pairOf(text);
  if (!range || !(std::max(std::abs(range->first), std::abs(range->second)) <= kMostDensity)) return std::nullopt;
  if (static_cast<float>(range->first) == static_cast<float>(range->second)) return std::nullopt;  // as they are drawn
  return SliceRange{range->first, range->second};
}

}  // namespace palpate
