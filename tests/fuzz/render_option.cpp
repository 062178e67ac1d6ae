// SPDX-License-Identifier: Apache-2.0
// One option of `palpate render`, as FLAG=TEXT. What is accepted can be drawn of a volume around the world's origin, or
// is refused in words: its style is valid, and its cameras are those that the kernel takes.
#include "apps/render/asked_style.hpp"
#include "apps/render/fit_camera.hpp"
#include "apps/render/render_options.hpp"
#include "engine/draw/draw_push.hpp"
#include "fuzz_target.hpp"

namespace {

using namespace palpate;

const BrickGrid kGrid{Vec3i::Constant(64), Vec3::Constant(1e-3)};
const layout::PoolDomain kDomain{64, 64, 64, 8, 8, 8};

Lattice aroundTheOrigin() {
  Lattice lattice;
  lattice.origin_W = Vec3::Constant(-0.0315);
  return lattice;
}

// `flag`: of the only option. Only the camera may still be refused: it may be too far away for floats.
void requireDrawable(const RenderRequest& request, const std::string& flag) {
  const Lattice lattice = aroundTheOrigin();
  DrawStyle style;
  if (!fuzz::accepts(flag, [&] { style = styleOf(request, lattice, kGrid.size); })) return;
  fuzz::mustAccept("a style that was accepted", [&] { checkStyle(style); });
  fuzz::require(request.frames >= 1 && request.frames <= 3600, "the number of frames");
  const SeenExtent extent = wholeExtent(kGrid, lattice, style.clips);
  fuzz::require(!extent.points_W.empty(), "clip planes that were accepted leave something");
  const double distance_m = request.distance_m ? *request.distance_m : fittingDistance(request, extent);
  const Camera camera = frameCamera(request, targetOf(request, extent), distance_m, request.frames - 1);
  const double isovalue = request.isovalue.value_or(0);
  fuzz::accepts("camera", [&] { (void)drawPush(kDomain, lattice, camera, isovalue); });
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
  if (fuzz::accepts(flag, [&] { setRenderOptions(given, request); })) requireDrawable(request, flag);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  check(fuzz::textOf(data, size));
  return 0;
}
