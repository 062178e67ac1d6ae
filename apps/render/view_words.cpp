// SPDX-License-Identifier: Apache-2.0
#include "apps/render/view_words.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include <fmt/format.h>

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

// "12" [mm] or "50%".
struct Place {
  double place;
  bool is_share;
};

std::optional<Place> placeOf(std::string_view text) {
  const bool is_share = text.ends_with('%');
  if (is_share) text.remove_suffix(1);
  const auto number = numberOf(text);
  if (!number) return std::nullopt;
  if (is_share && *number >= 0 && *number <= 100) return Place{*number / 100, true};
  if (!is_share && std::abs(*number) <= kFarthest_mm) return Place{*number * kMetresPerMillimetre, false};
  return std::nullopt;
}

// The same place counted against the direction.
Place turned(const Place& place) {
  return {place.is_share ? 1 - place.place : -place.place, place.is_share};
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

std::optional<AskedPlane> planeOf(std::string_view text) {
  const std::string whole(text);
  if (const std::size_t at = text.find('@'); at != std::string_view::npos) {
    const auto normal = vectorOf(text.substr(0, at));
    const auto place = placeOf(text.substr(at + 1));
    if (!normal || normal->isZero(0) || !place) return std::nullopt;
    return AskedPlane{whole, normal->stableNormalized(), place->place, place->is_share};
  }
  const bool against = text.starts_with('-');
  if (against) text.remove_prefix(1);
  if (text.size() < 3 || text[0] < 'x' || text[0] > 'z' || text[1] != '=') return std::nullopt;
  const auto along = placeOf(text.substr(2));
  if (!along) return std::nullopt;
  const Place place = against ? turned(*along) : *along;
  return AskedPlane{whole, (against ? -1 : 1) * Vec3::Unit(text[0] - 'x'), place.place, place.is_share};
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

std::string boxWords(const WorldBox& box) {
  const Vec3 low_mm = (box.low_W * kMillimetresPerMetre).array() + 0.0;  // no -0
  const Vec3 high_mm = (box.high_W * kMillimetresPerMetre).array() + 0.0;
  return fmt::format("{:.6g},{:.6g},{:.6g} to {:.6g},{:.6g},{:.6g} mm", low_mm.x(), low_mm.y(), low_mm.z(), high_mm.x(),
                     high_mm.y(), high_mm.z());
}

}  // namespace palpate
