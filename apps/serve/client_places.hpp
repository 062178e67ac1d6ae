// SPDX-License-Identifier: Apache-2.0
// apps/serve/client_places.hpp: who may stay at a service when more want to than there are places for.
//
// There are kPlaces for clients. Where all are taken, the client that has asked nothing for the longest time goes, if
// that is kIdle_s or more, nothing of its is under way, and it does not look on. If none is idle, whoever comes is let
// in on trial: a servo, `ctl status` and `ctl stop` get through, others are told that there is no room. So clients that
// nobody looks after keep neither a hand without force nor the operator out. Those on trial leave after kTrial_s, and
// kOnTrial of them are there at once; who comes meanwhile waits before the door.
// Pure: no clock, no sockets. Any thread.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace palpate {

struct ClientPlaces {
  static constexpr std::size_t kPlaces = 32, kOnTrial = 8;
  static constexpr double kIdle_s = 10, kTrial_s = 0.5;

  struct Guest {
    std::int64_t heard_ns = 0;  // when it asked last, or came
    bool is_busy = false;       // it waits for an answer, or looks on
    bool on_trial = false;
  };
  enum class Entry : std::uint8_t { kWithAPlace, kOnTrial, kNotYet };

  // For one more guest, once whoever outstayed() is gone.
  [[nodiscard]] static Entry entryOf(std::span<const Guest> guests) {
    const auto on_trial = static_cast<std::size_t>(std::ranges::count_if(guests, &Guest::on_trial));
    if (guests.size() - on_trial < kPlaces) return Entry::kWithAPlace;
    return on_trial < kOnTrial ? Entry::kOnTrial : Entry::kNotYet;
  }
  // Who makes room where all places are taken: an index.
  [[nodiscard]] static std::optional<std::size_t> outstayed(std::span<const Guest> guests, std::int64_t now_ns) {
    std::optional<std::size_t> idlest;
    std::size_t places = 0;
    for (std::size_t i = 0; i < guests.size(); ++i) {
      if (guests[i].on_trial) continue;
      ++places;
      if (guests[i].is_busy || secondsSince(guests[i].heard_ns, now_ns) < kIdle_s) continue;
      if (!idlest || guests[i].heard_ns < guests[*idlest].heard_ns) idlest = i;
    }
    return places < kPlaces ? std::nullopt : idlest;
  }
  [[nodiscard]] static bool trialIsOver(const Guest& guest, std::int64_t now_ns) {
    return guest.on_trial && !guest.is_busy && secondsSince(guest.heard_ns, now_ns) >= kTrial_s;
  }
  [[nodiscard]] static double secondsSince(std::int64_t then_ns, std::int64_t now_ns) {
    return static_cast<double>(now_ns - then_ns) * 1e-9;
  }
};

}  // namespace palpate
