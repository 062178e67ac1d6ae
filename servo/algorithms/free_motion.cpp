// SPDX-License-Identifier: Apache-2.0
#include "servo/algorithms/free_motion.hpp"

#include "servo/safety/faults.hpp"

namespace palpate {

std::optional<Entry> FreeMotion::move(const IsoField& field, std::uint64_t edit_version, const Vec3& hip_W,
                                      std::uint32_t& faults) noexcept {
  const Probe hip = field.probe(hip_W);
  hip_side_ = hip.side;
  if (hip.side == Side::kUnknown) {
    faults |= bit(ServoFault::kBeyondWindow);
    return std::nullopt;
  }
  if (edit_version != edit_version_) {
    edit_version_ = edit_version;
    // Material that an edit put over the last free place is no entry.
    armed_ = armed_ && field.probe(free_.p_W).side != Side::kInside;
  }
  const std::optional<Entry> entry = armed_ ? field.firstEntry(free_, hip) : std::nullopt;
  if (hip.side == Side::kOutside) {
    armed_ = true;
    free_ = hip;
  } else if (entry) {
    armed_ = false;
  } else {
    faults |= bit(ServoFault::kInsideObject);
  }
  return entry;
}

void FreeMotion::release(const Probe& hip, std::uint64_t edit_version) noexcept {
  armed_ = hip.side == Side::kOutside;
  free_ = hip;
  edit_version_ = edit_version;
}

}  // namespace palpate
