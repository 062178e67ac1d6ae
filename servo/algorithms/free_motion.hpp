// SPDX-License-Identifier: Apache-2.0
// servo/algorithms/free_motion.hpp: the HIP while nothing holds it: where does its way enter the object?
//
// The way from the last place known to be outside to the HIP is searched for its first crossing. Inside at the start:
// no entry until the HIP has been outside once (kInsideObject); the same where a contact was lost in the object
// (kSurfaceLost, in every tick until then). Where an edit has buried a free tool, its nearest way
// out is its entry (IsoField::nearestExit), if there is one in reach. A tick that
// cannot see the HIP (kBeyondWindow) is bridged by the straight line of the next one that can.
// Frame W: world [m]. Thread: the servo's. Cost: one fetch and IsoField::firstEntry, which for most ways in free space
// takes none; IsoField::nearestExit in the tick after an edit that buried the tool. Errors: faults.
#pragma once

#include <optional>

#include "servo/algorithms/iso_field.hpp"

namespace palpate {

class FreeMotion {
 public:
  void reset() noexcept { *this = FreeMotion(); }

  // Every tick that can see the HIP, in contact too: the window holds that edit. True: another than the last one did.
  bool see(std::uint64_t edit_version) noexcept;
  // The first entry on the way to the HIP; the caller is in contact then, or calls release().
  [[nodiscard]] std::optional<Entry> move(const IsoField& field, const Vec3& hip_W, std::uint32_t& faults) noexcept;
  // Contact has ended with the HIP there.
  void release(const Probe& hip) noexcept;
  // As release(); its surface is gone: kSurfaceLost if the HIP is in the object, or deeper than the window shows.
  void lose(const Probe& hip, std::uint32_t& faults) noexcept;
  // Of the last move().
  [[nodiscard]] Side hipSide() const noexcept { return hip_side_; }

 private:
  Probe free_;          // the last place known to be outside, if armed
  bool armed_ = false;  // there is one
  bool lost_ = false;   // a contact was lost with the HIP in the object, where it still is
  Side hip_side_ = Side::kUnknown;
  std::uint64_t edit_version_ = 0;
  bool edited_ = false;  // since free_ was found
};

}  // namespace palpate
