// SPDX-License-Identifier: Apache-2.0
#include "servo/algorithms/hri_paper.hpp"

#include <cmath>

#include "servo/safety/faults.hpp"

namespace palpate {

void HriPaperSurface::reset(const Vec3& hip_W) noexcept {
  cache_.forget();
  vhip_W_ = hip_W;
  has_plane_ = false;
  c_ = 0;
  age_ticks_ = 0;
}

std::optional<Vec3> HriPaperSurface::point(const IsoField& field, const Probe& vhip, const Probe& hip) const noexcept {
  const Vec3 line_W = hip.p_W - vhip.p_W;
  if (point_ == PaperPoint::kFromTheEnds) {
    const double t = std::isinf(vhip.density) ? 1.0 : (field.isovalue() - vhip.density) / (hip.density - vhip.density);
    return vhip.p_W + t * line_W;
  }
  if (vhip.side == Side::kOutside) {
    const auto entry = field.firstEntry(vhip, hip);
    return entry ? std::optional<Vec3>(entry->p_W) : std::nullopt;
  }
  const Vec3 outward_W = line_W.normalized() * (-IsoField::kLongestWayOut * field.voxel());
  const auto exit = field.firstExit(vhip, vhip.p_W + outward_W);
  return exit ? std::optional<Vec3>(exit->p_W) : std::nullopt;
}

// p, and N = SurfaceNormal(p).
void HriPaperSurface::makePlane(const IsoField& field, const Probe& vhip, const Probe& hip,
                                std::uint32_t& faults) noexcept {
  has_plane_ = false;
  const auto p_W = point(field, vhip, hip);
  if (!p_W) {
    faults |= bit(ServoFault::kSurfaceLost);
    return;
  }
  const Fetch at_p = field.sampler().at(*p_W);
  const double steepness = at_p.gradient_W.norm();  // [density/m]
  if (at_p.place != Place::kInside || !(steepness > 0) || !std::isfinite(steepness)) {
    faults |= bit(ServoFault::kZeroGradient);
    return;
  }
  p_W_ = *p_W;
  normal_W_ = at_p.gradient_W / -steepness;
  has_plane_ = true;
  age_ticks_ = 0;
}

// The first half of Figure 2, without the counter.
void HriPaperSurface::updatePlane(const IsoField& field, const Vec3& hip_W, std::uint32_t& faults) noexcept {
  const Probe hip = field.probe(hip_W);
  const bool unseen = hip.side == Side::kUnknown;
  const bool held = unseen && has_plane_ && point_ == PaperPoint::kOnTheLine && plane().depth(hip_W) > 0;
  if (hip.side != Side::kInside && !held) {
    if (unseen) faults |= bit(ServoFault::kBeyondWindow);
    has_plane_ = false;
    return;
  }
  const Probe vhip = field.probe(vhip_W_);
  if (vhip.side == Side::kUnknown) {
    faults |= bit(ServoFault::kBeyondWindow);
    has_plane_ = false;
    return;
  }
  if (has_plane_ || vhip.side == Side::kOutside) makePlane(field, vhip, hip, faults);
}

// Figure 2, without the force.
bool HriPaperSurface::find(const SampleWindow& window, const Vec3& hip_W, std::uint32_t& faults) noexcept {
  if (has_plane_) ++age_ticks_;
  if (!window.usable()) {
    has_plane_ = false;
    faults |= bit(ServoFault::kNoWindow);
  } else if (has_plane_ && c_ < n_) {
    ++c_;
  } else {
    if (has_plane_) c_ = 0;
    updatePlane(cache_.of(window), hip_W, faults);
  }
  const bool touching = has_plane_ && plane().depth(hip_W) > 0;
  vhip_W_ = touching ? plane().nearest(hip_W) : hip_W;
  return touching;
}

}  // namespace palpate
