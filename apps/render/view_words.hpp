// SPDX-License-Identifier: Apache-2.0
// apps/render/view_words.hpp: views, planes and sizes of pictures as words. Each function returns nothing for text that
// has not the form. Any thread.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/render/render_request.hpp"
#include "base/lattice.hpp"

namespace palpate {

// The six sides of a patient: front, back, left, right, top, bottom. "left" is the patient's left, +x. From the front
// the patient's left is on the right of the picture, as in radiology. From the top and from the bottom the patient's
// front is up in the picture.
[[nodiscard]] std::vector<std::string> viewNames();
[[nodiscard]] std::optional<ViewAngles> viewNamed(std::string_view name);

// "AZIMUTH,ELEVATION" [degree], from -360 to 360 and from -90 to 90.
[[nodiscard]] std::optional<ViewAngles> viewAnglesOf(std::string_view text);

// A plane and its kept side. "x=12": at x = 12 mm, kept is where x is larger. "-x=12": the same plane, kept is where x
// is smaller. "NX,NY,NZ@MM": at MM along this normal (of any length but 0) from the world's origin, kept is where the
// normal points. Places are at most kFarthest_mm from the origin. "50%" in place of a length, 0 to 100: half way
// through the volume's extent along that axis or normal.
inline constexpr double kFarthest_mm = 1e6;
[[nodiscard]] std::optional<AskedPlane> planeOf(std::string_view text);

// "WIDTHxHEIGHT" [pixel]: whole numbers above 0.
struct PictureSize {
  int width = 0, height = 0;
};
[[nodiscard]] std::optional<PictureSize> pictureSizeOf(std::string_view text);

// "BLACK,WHITE" [density]: two numbers that differ as floats, neither beyond kMostDensity.
inline constexpr double kMostDensity = 3.4e38;
[[nodiscard]] std::optional<SliceRange> sliceRangeOf(std::string_view text);

// "-90,-91,-71 to 90,125,109 mm".
[[nodiscard]] std::string boxWords(const WorldBox& box);

}  // namespace palpate
