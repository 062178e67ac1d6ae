// SPDX-License-Identifier: Apache-2.0
#include "apps/render/render_options.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/render/view_words.hpp"
#include "apps/scene/option_value.hpp"
#include "base/byte_size.hpp"
#include "base/error.hpp"
#include "base/nearest_word.hpp"
#include "shaders/draw.layout.h"

namespace palpate {
namespace {

constexpr const char* kText = "text";
constexpr int kMostFrames = 3600;  // a tenth of a degree each

// Numbers from `lowest` to `highest`, both in screen units; times `scale` they are SI.
struct Limits {
  double lowest = 0, highest = 0;
  double scale = 1;
};

// Of densities, which have no limits but a float's.
constexpr Limits kDensities = {-kMostDensity, kMostDensity};

std::string rangeWords(const Limits& limits) {
  if (limits.highest >= kMostDensity) return "a number that a 32-bit float holds";
  return fmt::format("a number from {} to {}", limits.lowest, limits.highest);
}

template <typename Member>
RenderOption numberRow(const char* flag, const char* placeholder, const char* unit, const char* help,
                       Member RenderRequest::*member, const Limits& limits) {
  RenderOption row;
  row.flag = flag;
  row.placeholder = placeholder;
  row.unit = unit;
  row.help = help;
  row.takes = rangeWords(limits);
  if constexpr (std::is_same_v<Member, double>)
    row.standard = fmt::format("{:g}", RenderRequest{}.*member / limits.scale);
  row.set = [=](const std::string& text, RenderRequest& request) {
    const auto number = numberOf(text);
    if (!number || !(*number >= limits.lowest && *number <= limits.highest)) return false;
    request.*member = *number * limits.scale;
    return true;
  };
  return row;
}

RenderOption textRow(const char* flag, const char* placeholder, const char* help, std::string RenderRequest::*member) {
  RenderOption row;
  row.flag = flag;
  row.placeholder = placeholder;
  row.takes = kText;
  row.help = help;
  row.set = [=](const std::string& text, RenderRequest& request) {
    request.*member = text;
    return !text.empty();
  };
  return row;
}

// `read` gives a value, or nothing for text that has not the form. `member` takes it.
template <typename Read, typename Member>
RenderOption readRow(const char* flag, const char* placeholder, const char* unit, const std::string& takes,
                     const char* help, Read read, Member RenderRequest::*member) {
  RenderOption row;
  row.flag = flag;
  row.placeholder = placeholder;
  row.unit = unit;
  row.takes = takes;
  row.help = help;
  row.set = [=](const std::string& text, RenderRequest& request) {
    const auto value = read(text);
    if (value) request.*member = *value;
    return value.has_value();
  };
  return row;
}

RenderOption viewRow() {
  RenderOption row =
      readRow("--view", "", "", fmt::format("{}", fmt::join(viewNames(), ", ")),
              "side of the patient that is seen; left is the patient's", viewNamed, &RenderRequest::view);
  row.words = viewNames();
  row.standard = row.words.front();
  return row;
}

RenderOption fromRow() {
  RenderOption row =
      readRow("--from", "AZIMUTH,ELEVATION", "degree", "AZIMUTH,ELEVATION: -360 to 360 and -90 to 90",
              "direction in which the camera is: azimuth 0 in front and 90 at the patient's left, elevation 90 above",
              viewAnglesOf, &RenderRequest::view);
  row.excludes = {"--view"};
  return row;
}

RenderOption sizeRow() {
  RenderOption row;
  row.flag = "--size";
  row.placeholder = "WIDTHxHEIGHT";
  row.unit = "pixel";
  row.takes = fmt::format("WIDTHxHEIGHT: 1 to {} each, at most {} in all", PICTURE_MOST_SIDE, PICTURE_MOST_PIXELS);
  row.standard = fmt::format("{}x{}", RenderRequest{}.width, RenderRequest{}.height);
  row.help = "size of the picture";
  row.set = [](const std::string& text, RenderRequest& request) {
    const auto size = pictureSizeOf(text);
    if (!size || std::max(size->width, size->height) > PICTURE_MOST_SIDE ||
        PICTURE_MOST_PIXELS / size->width < size->height)
      return false;
    request.width = size->width;
    request.height = size->height;
    return true;
  };
  return row;
}

RenderOption framesRow() {
  RenderOption row;
  row.flag = "--frames";
  row.placeholder = "COUNT";
  row.takes = fmt::format("a whole number from 1 to {}", kMostFrames);
  row.standard = "1";
  row.help = "pictures of a whole turn around the vertical axis, to the patient's left: out_000.png, out_001.png ...";
  row.set = [](const std::string& text, RenderRequest& request) {
    const auto number = numberOf(text);
    if (!number || !(*number >= 1 && *number <= kMostFrames) || *number != std::floor(*number)) return false;
    request.frames = static_cast<int>(*number);
    return true;
  };
  return row;
}

RenderOption targetRow() {
  const auto read = [](const std::string& text) -> std::optional<Vec3> {
    const auto place_mm = vectorOf(text);
    if (!place_mm || !(place_mm->cwiseAbs().maxCoeff() <= kFarthest_mm)) return std::nullopt;
    return Vec3(*place_mm * kMetresPerMillimetre);
  };
  return readRow("--target", "X,Y,Z", "mm", "X,Y,Z",
                 "point of the world in the middle of the picture; the middle of the object if not given", read,
                 &RenderRequest::target_W);
}

RenderOption planesRow(const char* flag, const char* help, std::size_t most,
                       std::vector<AskedPlane> RenderRequest::*member) {
  RenderOption row;
  row.flag = flag;
  row.placeholder = "PLANE";
  row.unit = "mm, or % of the volume's extent";
  row.takes = "x=12, x=50%, -x=12 (so y and z), NX,NY,NZ@12 or NX,NY,NZ@50%";
  row.help = help;
  row.most = most;
  row.set = [=](const std::string& text, RenderRequest& request) {
    const auto plane = planeOf(text);
    if (plane) (request.*member).push_back(*plane);
    return plane.has_value();
  };
  return row;
}

RenderOption opacityRow() {
  RenderOption row = numberRow("--second-opacity", "SHARE", "", "how much of the first surface the second one hides",
                               &RenderRequest::second_opacity, {0, 1});
  row.needs = "--second";
  return row;
}

RenderOption sliceRangeRow() {
  RenderOption row =
      readRow("--slice-range", "BLACK,WHITE", "density", "BLACK,WHITE: two numbers that differ",
              "densities that slices show black and white; if not given those that 0.5 and 99.5 % of the "
              "voxels do not exceed",
              sliceRangeOf, &RenderRequest::slice_range);
  row.needs = "--slice";
  return row;
}

RenderOption occlusionRow() {
  RenderOption row;
  row.flag = "--occlusion";
  row.takes = "on or off";
  row.standard = RenderRequest{}.occlusion ? "on" : "off";
  row.help = "hollows are darker; so is all of a rough surface";
  row.words = {"on", "off"};
  row.set = [](const std::string& text, RenderRequest& request) {
    request.occlusion = text == "on";
    return text == "on" || text == "off";
  };
  return row;
}

RenderOption normalsRow() {
  RenderOption row;
  row.flag = "--normals";
  row.help = "red, green and blue are the normal to the right, up and to the camera: -1 is 0, 1 is 255";
  row.excludes = {"--second", "--slice", "--occlusion"};  // a picture of normals shows nothing else
  row.set = [](const std::string&, RenderRequest& request) { return request.normals = true; };
  return row;
}

RenderOption memoryRow() {
  RenderOption row;
  row.flag = "--gpu-memory";
  row.placeholder = "SIZE";
  row.takes = "a size like 512MiB or 2GiB, 0: what it has";
  row.standard = "0";
  row.help = "most that densities may take on the Vulkan device";
  row.set = [](const std::string& text, RenderRequest& request) {
    request.gpu_memory_bytes = byteSize(text, "--gpu-memory");
    return true;
  };
  return row;
}

std::vector<RenderOption> allRows() {
  return {
      numberRow("--iso", "DENSITY", "density", "above it is object; as `palpate touch` chooses it if not given",
                &RenderRequest::isovalue, kDensities),
      sizeRow(),
      viewRow(),
      fromRow(),
      targetRow(),
      numberRow("--distance", "MM", "mm", "from the camera to the target; if not given so that all is in the picture",
                &RenderRequest::distance_m, {1e-3, kFarthest_mm, kMetresPerMillimetre}),
      numberRow("--fov", "DEG", "degree", "angle of view from the lower to the upper edge", &RenderRequest::fov_rad,
                {1, 120, 1 / kDegreesPerRadian}),
      numberRow("--zoom", "TIMES", "", "times larger around the middle, by a narrower angle of view",
                &RenderRequest::zoom, {0.1, 1000}),
      framesRow(),
      planesRow(
          "--clip",
          "plane in front of which alone things are drawn: where x is larger, smaller, or where the normal points; "
          "as often as wanted",
          DRAW_MOST_CLIPS, &RenderRequest::clips),
      planesRow("--slice", "plane on which the density is shown; as often as wanted", DRAW_MOST_SLICES,
                &RenderRequest::slices),
      sliceRangeRow(),
      numberRow("--second", "DENSITY", "density",
                "isovalue of a second surface, translucent around the first: skin over bone; below the first one's; "
                "after a distance filter, where that is 0, in metres",
                &RenderRequest::second, kDensities),
      opacityRow(),
      occlusionRow(),
      normalsRow(),
      textRow("--filter", "FILTERS", "filters that the field goes through first: \"gaussian:0.8mm\"; docs/filters.md",
              &RenderRequest::filter),
      textRow("--gpu", "NAME", "part of the Vulkan device's name; the best one if not given", &RenderRequest::gpu),
      memoryRow(),
  };
}

bool isGiven(std::span<const std::vector<std::string>> given, const std::string& flag) {
  const auto& rows = renderOptions();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].flag == flag) return !given[i].empty();
  }
  return false;
}

}  // namespace

const std::vector<RenderOption>& renderOptions() {
  static const std::vector<RenderOption> kRows = allRows();
  return kRows;
}

std::string optionHelp(const RenderOption& option) {
  std::string text = option.help;
  if (!option.unit.empty()) text += " [" + option.unit + "]";
  if (option.isBare()) return text;
  std::vector<std::string> form;
  if (option.takes != kText) form.push_back(option.takes);
  if (option.most > 1) form.push_back(fmt::format("at most {}", option.most));
  if (!option.standard.empty()) form.push_back("default " + option.standard);
  return form.empty() ? text : fmt::format("{} ({})", text, fmt::join(form, "; "));
}

void setRenderOptions(std::span<const std::vector<std::string>> given, RenderRequest& request) {
  const auto& rows = renderOptions();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const RenderOption& row = rows[i];
    if (given[i].empty()) continue;
    if (given[i].size() > row.most)
      refuse(row.flag, fmt::format("{} are given", given[i].size()), fmt::format("give at most {}", row.most));
    if (!row.needs.empty() && !isGiven(given, row.needs))
      refuse(row.flag, "it has no effect without " + row.needs, fmt::format("give {} too, or leave it out", row.needs));
    for (const std::string& other : row.excludes) {
      if (isGiven(given, other)) refuse(row.flag, fmt::format("{} is given too", other), "leave one of them out");
    }
    for (const std::string& text : given[i]) {
      if (row.set(text, request)) continue;
      const std::string unit = row.unit.empty() ? "" : ", in " + row.unit;
      refuse(row.flag, fmt::format("'{}' is not what it takes", text),
             withDidYouMean(text, row.words, "give " + row.takes + unit));
    }
  }
}

}  // namespace palpate
