// SPDX-License-Identifier: Apache-2.0
// servo/algorithms/free_motion.hpp: the HIP while nothing holds it: where does its way enter the object?
//
// The way from the last place known to be outside to the HIP is searched for its first crossing. Inside at the start,
// or after an edit has buried the tool: no entry until the HIP has been outside once (kInsideObject). A tick that
// cannot see the HIP (kBeyondWindow) is bridged by the straight line of the next one that can.
// Frame W: world [m]. Thread: the servo's. Cost: one fetch and IsoField::firstEntry, which for a short way that does
// not enter takes none. Errors: faults.
#pragma once

#include <optional>

#include "servo/algorithms/iso_field.hpp"

namespace palpate {

class FreeMotion {
 public:
  void reset() noexcept { *this = FreeMotion(); }

  // The first entry on the way to the HIP; the caller is in contact then, or calls release().
  [[nodiscard]] std::optional<Entry> move(const IsoField& field, std::uint64_t edit_version, const Vec3& hip_W,
                                          std::uint32_t& faults) noexcept;
  // Contact has ended with the HIP there, in the volume as it was after `edit_version`.
  void release(const Probe& hip, std::uint64_t edit_version) noexcept;
  // Of the last move().
  [[nodiscard]] Side hipSide() const noexcept { return hip_side_; }

 private:
  Probe free_;          // the last place known to be outside, if armed
  bool armed_ = false;  // there is one
  Side hip_side_ = Side::kUnknown;
  std::uint64_t edit_version_ = 0;
};

}  // namespace palpate
