// SPDX-License-Identifier: Apache-2.0
// One option of `palpate render`, as FLAG=TEXT. What is accepted can be drawn: its style is valid, its picture is
// within the limits, and its cameras are finite.
#include "apps/render/fit_camera.hpp"
#include "apps/render/render_options.hpp"
#include "fuzz_target.hpp"

namespace {

using namespace palpate;

void requireDrawable(const RenderRequest& request) {
  DrawStyle style;
  style.clips = request.clips;
  style.slices = request.slices;
  style.other_isovalue = request.second;
  style.other_opacity = request.second_opacity;
  if (request.slice_range) {
    style.slice_black = request.slice_range->black;
    style.slice_white = request.slice_range->white;
  }
  fuzz::mustAccept("a style that was accepted", [&] { checkStyle(style); });
  fuzz::require(request.width > 0 && request.height > 0 && request.width <= (1 << 24) / request.height, "the size");
  fuzz::require(request.frames >= 1 && request.frames <= 3600, "the number of frames");
  const SeenExtent extent = wholeExtent({Vec3i::Constant(8), Vec3::Ones()}, {});
  const double distance_m = request.distance_m ? *request.distance_m : fittingDistance(request, extent);
  const Camera camera = frameCamera(request, targetOf(request, extent), distance_m, request.frames - 1);
  fuzz::require(camera.position_W.allFinite() && camera.up_W.allFinite() && camera.right_W.allFinite(), "the camera");
  fuzz::require(camera.vertical_fov_rad > 0 && camera.vertical_fov_rad < 3.14, "the angle of view");
}

void check(const std::string& input) {
  const std::size_t equals = input.find('=');
  if (equals == std::string::npos) return;
  const auto& rows = renderOptions();
  std::vector<std::vector<std::string>> given(rows.size());
  std::string flag;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (input.substr(0, equals) != rows[i].flag) continue;
    flag = rows[i].flag;
    given[i] = {input.substr(equals + 1)};
    for (std::size_t other = 0; other < rows.size(); ++other) {  // without it the option would have no effect
      if (rows[other].flag == rows[i].needs) given[other] = {rows[other].flag == "--slice" ? "x=0" : "0"};
    }
  }
  if (flag.empty()) return;
  RenderRequest request;
  if (fuzz::accepts(flag, [&] { setRenderOptions(given, request); })) requireDrawable(request);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  check(fuzz::textOf(data, size));
  return 0;
}
