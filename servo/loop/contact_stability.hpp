// SPDX-License-Identifier: Apache-2.0
// servo/loop/contact_stability.hpp: was the contact quiet, slightly active, or unstable? From the records of a run.
//
// Three things can be true of a sampled wall, and only the last is a fault:
//  quiet            no contact gave more energy than it had taken.
//  slightly active  some did, by a bounded amount, and the tool came to rest. Every sampled wall with less damping than
//                   K T / 2 does so (Colgate and Schenkel 1997), and the hand and the device take it up. So does an
//                   edit under the tool, and a field whose normals are not those of its surface.
//  unstable         the tool swings against the surface and does not settle, fed by it: a limit cycle or growth.
//
// Energy, by contact. A contact goes from the first tick with contact or force to where both are over. What it gave is
// how far E (passivity.hpp) fell below its value at the begin; what it had stored is how far E rose. It is quiet if it
// gave at most kQuietShare of the most that any contact of the run had stored, and the encoders' error, Delta times the
// sum of the force's changes along each axis.
//
// Swings. The height of the HIP over the plane in contact (over the last one, while the tool is off it) turns up and
// down; a swing goes from one turn to the next, and counts from kLeastSwing_m and kLeastSwing_steps of the encoders:
// from one step to the second next and back is what rounding alone can keep up in a loop that is stable without it. The
// contact is unstable if kSwings swings follow each other of which
//  - the last half is not smaller than kSustained of the first half, so they do not die away. At kSwings = 20 a swing
//    that loses 5.6 % a period, a damping ratio of 0.009, is on the border;
//  - neither the hand nor the surface asks for them: the heights of the swings add up to more than kUnasked times the
//    ways of the hand's path, of the surface and of what effects put on it, along the normal in the same time. So a
//    path that taps, a texture and a noisy surface are none, unless the contact answers them with a resonance of more
//    than that. What an effect adds in proportion to the depth is stiffness and asks for nothing. Where the path is not
//    known, swings slower than kHand_hz are left out instead, for a hand can make them. Or, whatever the surface asks
//    for, the path asks for none and the tool left the surface in each period while the hand wanted it inside;
//  - the surface fed them: E fell from the first to the last. So stick-slip, which friction takes energy from, is none.
// A contact that is lost because the surface ends under the tool (the HIP is still below the plane) starts the count
// anew, and so do a fading fault and half a second out of contact. A hand that is exactly on its path cannot bounce:
// its height is the path's own.
//
// Frame W: world [m, N]. Thread: any, after the run. Cost: one pass over the records. Errors: none.
#pragma once

#include <cstdint>
#include <span>

#include "servo/devices/path.hpp"
#include "servo/loop/tick_record.hpp"

namespace palpate {

enum class ContactVerdict { kNoContact, kQuiet, kSlightlyActive, kUnstable };

// What a slightly active contact has its energy from, as far as the conditions of the run say.
enum class ActivitySource { kNone, kEdits, kSampledWall, kField };

struct ContactConditions {
  double resolution_m = 0;      // of the device's encoders [m]
  int delay_ticks = 0;          // of the device's force
  double lacking_Ns_per_m = 0;  // what the wall's damping is below K T / 2 + K T delay; at most 0: it is not [N s/m]
  const Path* path = nullptr;   // where the hand wanted the tool; null: not known
};

struct ContactStability {
  ContactVerdict verdict = ContactVerdict::kNoContact;
  ActivitySource source = ActivitySource::kNone;  // of what given_J says, where the verdict is not quiet
  // Of the contact that gave most beyond its error, or, where none did, that gave most:
  double given_J = 0;    // more than it had taken
  double error_J = 0;    // bound of what the encoders put into that
  double stored_J = 0;   // the most that any contact of the run had taken at once
  double share = 0;      // given / stored; 0 where nothing was stored [-]
  double allowed_J = 0;  // error and quiet share of all contacts together: an end energy within it is none
  // Of the swings:
  int bounces = 0;              // contact was left outwards while the hand wanted the tool inside
  double swing_m = 0;           // mean of the kSwings that made it unstable, of the largest such [m]
  double swing_hz = 0;          // two swings are a period [1/s]
  double unstable_from_s = -1;  // begin of the first of them [s]; -1: none
  double unstable_to_s = -1;    // end of the last

  static constexpr double kQuietShare = 0.01;
  static constexpr int kSwings = 20;
  static constexpr double kLeastSwing_m = 2e-6;
  static constexpr double kLeastSwing_steps = 2.5;
  static constexpr double kSustained = 0.75;
  static constexpr double kUnasked = 10;
  static constexpr double kHand_hz = 12;
  static constexpr double kLongestFlight_s = 0.5;
};

[[nodiscard]] ContactStability assessContact(std::span<const TickRecord> records, const ContactConditions& conditions);

// "no-contact", "quiet", "slightly-active", "unstable".
[[nodiscard]] const char* name(ContactVerdict verdict) noexcept;
// "none", "edits", "sampled-wall", "field".
[[nodiscard]] const char* name(ActivitySource source) noexcept;

}  // namespace palpate
