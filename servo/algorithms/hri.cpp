// SPDX-License-Identifier: Apache-2.0
#include "servo/algorithms/hri.hpp"

#include <algorithm>

#include "servo/safety/faults.hpp"

namespace palpate {

Hri::Hri(const AlgorithmParameters& parameters, ContactEffects effects) noexcept
    : parameters_(parameters), effects_(std::move(effects)) {}

void Hri::reset(const Vec3& hip_W) noexcept {
  surface_ = {};
  vhip_W_ = hip_W;
  age_ticks_ = 0;
  in_contact_ = new_contact_ = held_ = armed_ = false;
  edit_version_ = field_version_ = 0;
  field_samples_ = nullptr;
  for (auto& effect : effects_) effect->release();
}

void Hri::tick(const TickInput& in, TickOutput& out) noexcept {
  out = TickOutput{};
  const SampleWindow& window = *in.window;
  new_contact_ = false;
  if (!window.usable()) {
    held_ = true;
    out.faults |= bit(ServoFault::kNoWindow);
  } else if (!in_contact_) {
    refreshField(window);
    moveFreely(in.hip_W, out.faults);
  } else {
    ++age_ticks_;
    const bool in_front = surface_.normal_W.dot(surface_.p_W - in.hip_W) <= 0;
    const bool due = age_ticks_ >= parameters_.plane_renewal_ticks;
    if (due || in_front || held_ || window.edit_version != edit_version_) {
      refreshField(window);
      renew(in.hip_W, out.faults);
    }
  }
  if (in_contact_ && !held_) {
    push(in, out);
  } else {
    vhip_W_ = in_contact_ ? vhip_W_ : in.hip_W;
    out.vhip_W = in.hip_W;
  }
}

void Hri::refreshField(const SampleWindow& window) noexcept {
  if (window.version != field_version_ || window.samples != field_samples_) {
    field_ = IsoField(window, parameters_.isovalue);
    field_version_ = window.version;
    field_samples_ = window.samples;
  }
  if (window.edit_version == edit_version_) return;
  edit_version_ = window.edit_version;
  if (in_contact_ || !armed_) return;
  // Material that an edit put over the last free point is no entry.
  const Probe again = field_.probe(free_.p_W);
  if (again.side == Side::kInside) armed_ = false;
  if (again.side == Side::kOutside) free_ = again;
}

// ---- in contact ----

void Hri::renew(const Vec3& hip_W, std::uint32_t& faults) noexcept {
  held_ = field_.sampler().place(hip_W) == Place::kBeyondWindow;
  if (!held_ && field_.sampler().place(surface_.p_W) == Place::kBeyondWindow) {
    // The window has left the old surface point behind; the plane under the HIP is the best that is known.
    surface_.p_W = hip_W + surface_.normal_W * surface_.normal_W.dot(surface_.p_W - hip_W);
  }
  const Track result = held_ ? Track::kBeyondWindow : SurfaceTracker::follow(field_, hip_W, surface_);
  switch (result) {
    case Track::kFound:
      if (surface_.normal_W.dot(surface_.p_W - hip_W) > 0) {
        age_ticks_ = 0;
      } else {
        relocate(field_.probe(hip_W), faults);
      }
      return;
    case Track::kBeyondWindow:
      held_ = true;
      faults |= bit(ServoFault::kBeyondWindow);
      return;
    case Track::kLeftVolume:
      release(field_.probe(hip_W));
      return;
    case Track::kFlat:
      relocate(field_.probe(hip_W), faults);
      return;
    case Track::kLost:
      faults |= bit(ServoFault::kSurfaceLost);
      relocate(field_.probe(hip_W), faults);
      return;
  }
}

// The HIP has left the sheet, or the sheet is gone: is there object between the VHIP and the HIP, or around the HIP?
void Hri::relocate(const Probe& hip, std::uint32_t& faults) noexcept {
  // The VHIP may be in the object by a rounding, so the search begins a little in front of it.
  const Probe start = field_.probe(vhip_W_ + surface_.normal_W * (kStandOff * field_.voxel()));
  const auto entry = field_.firstEntry(start, hip);
  if (entry && touch(*entry, hip, faults)) return;
  if (hip.side == Side::kInside) {  // both inside
    const auto way_out = field_.firstExit(hip, hip.p_W + surface_.normal_W * (kOutwardSearch * field_.voxel()));
    if (way_out && touch(*way_out, hip, faults)) return;
    faults |= bit(ServoFault::kInsideObject);
  }
  release(hip);
}

void Hri::release(const Probe& hip) noexcept {
  in_contact_ = false;
  age_ticks_ = 0;
  armed_ = hip.side == Side::kOutside;
  free_ = hip;
  for (auto& effect : effects_) effect->release();
}

// ---- free ----

void Hri::moveFreely(const Vec3& hip_W, std::uint32_t& faults) noexcept {
  const Probe hip = field_.probe(hip_W);
  if (hip.side == Side::kUnknown) {
    held_ = true;
    faults |= bit(ServoFault::kBeyondWindow);
    return;
  }
  const bool after_gap = held_;
  held_ = false;
  if (after_gap && armed_) {
    const bool near = (hip_W - free_.p_W).squaredNorm() <= kLongestGap * kLongestGap * field_.voxel() * field_.voxel();
    if (!near) armed_ = false;
    if (near) free_ = field_.probe(free_.p_W);
  }
  if (armed_) {
    const auto entry = field_.firstEntry(free_, hip);
    if (entry && touch(*entry, hip, faults)) return;
  }
  if (hip.side == Side::kOutside) {
    armed_ = true;
    free_ = hip;
  } else if (!armed_) {
    faults |= bit(ServoFault::kInsideObject);
  }
}

// Contact at an entry, if the surface point nearest to the HIP has the HIP behind it.
bool Hri::touch(const Entry& entry, const Probe& hip, std::uint32_t& faults) noexcept {
  SurfacePoint surface{entry.p_W, -entry.direction_W, entry.face};
  bool flat = false;
  if (entry.face.any()) {
    surface.normal_W = field_.sampler().faceNormal(entry.face.axis, entry.face.high);
  } else {
    const Vec3 gradient_W = field_.sampler().at(entry.p_W).gradient_W;
    flat = !(gradient_W.squaredNorm() > 0) || !gradient_W.allFinite();
    if (!flat) surface.normal_W = -gradient_W.normalized();
  }
  const auto behind = [&](const SurfacePoint& s) { return s.normal_W.dot(s.p_W - hip.p_W) > 0; };
  SurfacePoint nearest = surface;
  const Track result = flat ? Track::kFlat : SurfaceTracker::follow(field_, hip.p_W, nearest);
  if (flat || result == Track::kFlat) faults |= bit(ServoFault::kZeroGradient);
  if (result == Track::kFound && behind(nearest)) {
    settle(nearest);
    return true;
  }
  // Where the search strays, the plane at the entry itself still holds a HIP that is in the object.
  if (hip.side != Side::kInside || !behind(surface)) return false;
  settle(surface);
  return true;
}

void Hri::settle(const SurfacePoint& surface) noexcept {
  new_contact_ = !in_contact_;
  in_contact_ = true;
  surface_ = surface;
  age_ticks_ = 0;
}

// ---- force ----

Vec3 Hri::moveByEffects(const TickInput& in, Vec3 vhip_W) noexcept {
  const ContactState contact{in.hip_W,          in.hip_velocity_W, surface_.p_W,
                             surface_.normal_W, new_contact_,      age_ticks_ == 0};
  for (auto& effect : effects_) vhip_W = effect->move(contact, vhip_W);
  return vhip_W;
}

// Equations 2 and 3 of the paper. Without effects d lies along N; what effects add to it aside is a force of K alone.
void Hri::push(const TickInput& in, TickOutput& out) noexcept {
  const Vec3& normal_W = surface_.normal_W;
  const double depth_m = normal_W.dot(surface_.p_W - in.hip_W);
  const double damping_N = parameters_.damping_Ns_per_m * normal_W.dot(in.hip_velocity_W);
  vhip_W_ = in.hip_W + depth_m * normal_W;
  if (effects_.empty()) {
    out.force_W = std::max(0.0, parameters_.stiffness_N_per_m * depth_m - damping_N) * normal_W;
  } else {
    vhip_W_ = moveByEffects(in, vhip_W_);
    const Vec3 spring_W = parameters_.stiffness_N_per_m * (vhip_W_ - in.hip_W);
    const double along_N = normal_W.dot(spring_W);
    out.force_W = spring_W + normal_W * (std::max(0.0, along_N - damping_N) - along_N);
  }
  out.vhip_W = vhip_W_;
  out.normal_W = normal_W;
  out.in_contact = true;
  out.plane_age_ticks = age_ticks_;
}

}  // namespace palpate
