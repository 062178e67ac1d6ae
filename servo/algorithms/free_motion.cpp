// SPDX-License-Identifier: Apache-2.0
#include "servo/algorithms/free_motion.hpp"

#include "servo/safety/faults.hpp"

namespace palpate {

bool FreeMotion::see(std::uint64_t edit_version) noexcept {
  if (edit_version == edit_version_) return false;
  edit_version_ = edit_version;
  edited_ = true;
  return true;
}

std::optional<Entry> FreeMotion::move(const IsoField& field, const Vec3& hip_W, std::uint32_t& faults) noexcept {
  const Probe hip = field.probe(hip_W);
  hip_side_ = hip.side;
  if (hip.side == Side::kUnknown) {
    faults |= bit(ServoFault::kBeyondWindow);
    return std::nullopt;
  }
  bool buried = false;
  if (edited_) {
    edited_ = false;
    // Material that an edit put over the last free place is no entry.
    const Probe again = field.probe(free_.p_W);
    buried = armed_ && again.side == Side::kInside;
    armed_ = armed_ && !buried;
    if (again.side == Side::kOutside) free_ = again;
  }
  std::optional<Entry> entry;
  if (armed_) entry = field.firstEntry(free_, hip);
  if (buried) entry = field.nearestExit(hip);
  if (hip.side == Side::kOutside) {
    armed_ = true;
    lost_ = false;
    free_ = hip;
  } else if (entry) {
    armed_ = lost_ = false;
  } else {
    faults |= bit(lost_ ? ServoFault::kSurfaceLost : ServoFault::kInsideObject);
  }
  return entry;
}

void FreeMotion::release(const Probe& hip) noexcept {
  armed_ = hip.side == Side::kOutside;
  lost_ = false;
  free_ = hip;
  edited_ = false;
}

void FreeMotion::lose(const Probe& hip, std::uint32_t& faults) noexcept {
  release(hip);
  lost_ = hip.side != Side::kOutside;  // a HIP deeper than the window shows counts as in the object
  if (lost_) faults |= bit(ServoFault::kSurfaceLost);
}

}  // namespace palpate
