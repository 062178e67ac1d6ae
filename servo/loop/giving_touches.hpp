// SPDX-License-Identifier: Apache-2.0
// servo/loop/giving_touches.hpp: finds a tool that bounces on a surface which feeds the bounces, tick by tick.
//
// A bounce may be as slow as a tapping hand, and a tool may hop several times in each. What tells such a tool from a
// hand is what the surface gives. Touches that follow each other within kLongestFlight_s are a series. A surface feeds
// the series if, over its last kTouches touches or more up to kMostTouches,
// - they gave in sum more than kGiftShare of what they stored in sum;
// - the newer half of them stored at least SwingWatch::kSustained of what the older half did. A tool that lands bounces
//   less and less.
// A hand that taps on a slightly active wall makes such a series too. So the series means something only where the wall
// may be too stiff for the device. A touch during which the volume was edited begins the series anew.
// Thread: one. Cost: some 10 ns a tick. Heap, errors: none.
#pragma once

#include <array>
#include <cstddef>

#include "servo/loop/contact_energy.hpp"
#include "servo/loop/tick_record.hpp"

namespace palpate {

class GivingTouches {
 public:
  static constexpr std::size_t kTouches = 10, kMostTouches = 20;
  static constexpr double kGiftShare = 0.01;
  static constexpr double kLongestFlight_s = 1;

  // Of the device: resolution of its encoders [m], delay of its force [tick].
  GivingTouches(double resolution_m, int delay_ticks) noexcept : meter_(resolution_m, delay_ticks) {}

  // The next tick. Returns whether a touch ended with it that the surface fed, together with those before it.
  bool add(const TickRecord& record) noexcept;
  void forget() noexcept { count_ = 0; }

 private:
  [[nodiscard]] bool fed() const noexcept;

  ContactEnergyMeter meter_;
  std::array<ContactEnergy, kMostTouches> touches_{};  // ring of the series' newest
  std::size_t next_ = 0, count_ = 0;
  double end_s_ = 0;  // of the last touch [s]
};

}  // namespace palpate
