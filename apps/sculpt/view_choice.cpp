// SPDX-License-Identifier: Apache-2.0
#include "apps/sculpt/view_choice.hpp"

#include "apps/render/asked_style.hpp"
#include "base/error.hpp"

namespace palpate {
namespace {

AskedPlane across(int axis, double share, bool turned) {
  const double sign = turned ? -1 : 1;
  return {.normal_W = sign * Vec3::Unit(axis), .place = turned ? 1 - share : share, .is_share = true};
}

}  // namespace

DrawStyle styleOf(const ViewChoice& choice, const Lattice& lattice, const Vec3i& size) {
  RenderRequest request;
  request.occlusion = choice.occlusion;
  for (std::size_t i = 0; i < 3; ++i) {
    const int axis = static_cast<int>(i);
    if (choice.cuts[i].on) request.clips.push_back(across(axis, choice.cuts[i].share, choice.cuts[i].keeps_low));
    if (choice.slices[i].on) request.slices.push_back(across(axis, choice.slices[i].share, false));
  }
  request.slice_range = choice.slice_range;
  request.second = choice.second_isovalue;
  request.second_opacity = choice.second_opacity;
  try {
    DrawStyle style = styleOf(request, lattice, size);
    checkStyle(style);
    return style;
  } catch (const Error& error) {
    const bool of_cuts = error.input() == "--clip";  // which no flag has given here
    throw Error(error.code(), of_cuts ? "the cuts" : "the picture", error.reason(),
                of_cuts ? "move one, or flip it" : "choose another value");
  }
}

}  // namespace palpate
