// SPDX-License-Identifier: Apache-2.0
// servo/algorithms/free_motion.hpp: finds where a tool in free motion enters the object.
//
// The line from the last place known to be outside to the HIP is searched for its first crossing. A tool that starts
// inside has no entry until the HIP has been outside once (kInsideObject). The same holds after a contact was lost in
// the object (kSurfaceLost, in every tick until then). If an edit has buried a free tool, its entry is the nearest way
// out (IsoField::nearestExit), if there is one in reach. After ticks that could not see the HIP (kBeyondWindow), the
// next tick that can see it searches the straight line over the gap.
// Frame W: world [m]. Thread: the servo's. Cost: one fetch and IsoField::firstEntry, which takes none for most lines in
// free space; IsoField::nearestExit in the tick after an edit that buried the tool. Errors: faults.
#pragma once

#include <optional>

#include "servo/algorithms/iso_field.hpp"

namespace palpate {

class FreeMotion {
 public:
  void reset() noexcept { *this = FreeMotion(); }
  // The HIP was last outside at `free_W`. The next move() checks whether that place still is outside, as after an edit.
  void resume(const Vec3& free_W) noexcept {
    reset();
    free_.p_W = free_W;
    armed_ = edited_ = true;
  }

  // Call it in every tick with a usable window, in contact too, with the edit that the window holds. True if that is
  // another edit than in the last call.
  bool see(std::uint64_t edit_version) noexcept;
  // The first entry on the line to the HIP. The caller is then in contact, or calls release().
  [[nodiscard]] std::optional<Entry> move(const IsoField& field, const Vec3& hip_W, std::uint32_t& faults) noexcept;
  // Contact has ended; `hip` is where the HIP is.
  void release(const Probe& hip) noexcept;
  // As release(), but the surface is gone: raises kSurfaceLost if the HIP is in the object, or deeper than the window
  // shows.
  void lose(const Probe& hip, std::uint32_t& faults) noexcept;
  // The side of the HIP in the last move().
  [[nodiscard]] Side hipSide() const noexcept { return hip_side_; }

 private:
  Probe free_;          // the last place known to be outside, if armed_
  bool armed_ = false;  // free_ holds such a place
  bool lost_ = false;   // a contact was lost with the HIP in the object, and the HIP is still there
  Side hip_side_ = Side::kUnknown;
  std::uint64_t edit_version_ = 0;
  bool edited_ = false;  // there was an edit since free_ was found
};

}  // namespace palpate
