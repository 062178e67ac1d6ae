// SPDX-License-Identifier: Apache-2.0
// servo/loop/contact_energy.hpp: what each contact of a run stored and gave, tick by tick.
//
// A contact lasts from the first tick with contact or force until both are over, and for the delay of the device
// longer, since the last force acts until then. Energies are those of the passivity observer
// (servo/safety/passivity.hpp). Frame W: world [N]. Thread: one. Cost: some 10 ns a tick. Heap, errors: none.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>

#include "base/vec.hpp"
#include "servo/loop/tick_record.hpp"

namespace palpate {

struct ContactEnergy {
  double net_J = 0;     // what it gave in all; below zero: took
  double given_J = 0;   // the most that it had given beyond what it had taken
  double stored_J = 0;  // the most that it had taken beyond what it had given
  double error_J = 0;   // the most of it that the encoders can account for
  bool edited = false;  // the volume was edited meanwhile
};

class ContactEnergyMeter {
 public:
  ContactEnergyMeter(double resolution_m, int delay_ticks) noexcept
      : resolution_m_(resolution_m), delay_ticks_(delay_ticks) {}

  // The next tick. Returns whether a contact has ended with it.
  bool add(const TickRecord& record) noexcept {
    const Vec3 force_W = asVec3(record.force_W);
    const bool acts = record.in_contact || !force_W.isZero(0);
    const bool edited = std::exchange(edit_version_, record.edit_version) != record.edit_version && !first_;
    first_ = false;
    if (acts && !open_) {
      contact_ = {};
      begin_J_ = record.energy_J;
      open_ = true;
    }
    if (!open_) return false;
    contact_.edited = contact_.edited || edited;
    contact_.net_J = begin_J_ - record.energy_J;
    contact_.given_J = std::max(contact_.given_J, contact_.net_J);
    contact_.stored_J = std::max(contact_.stored_J, -contact_.net_J);
    contact_.error_J += resolution_m_ * (force_W - last_W_).lpNorm<1>();
    last_W_ = force_W;
    idle_ticks_ = acts ? 0 : idle_ticks_ + 1;
    open_ = idle_ticks_ <= delay_ticks_;
    return !open_;
  }

  [[nodiscard]] bool open() const noexcept { return open_; }
  // The contact that is open, or the last one.
  [[nodiscard]] const ContactEnergy& contact() const noexcept { return contact_; }

 private:
  double resolution_m_;
  int delay_ticks_;
  ContactEnergy contact_;
  bool open_ = false, first_ = true;
  double begin_J_ = 0;
  int idle_ticks_ = 0;
  std::uint64_t edit_version_ = 0;
  Vec3 last_W_ = Vec3::Zero();
};

}  // namespace palpate
