// SPDX-License-Identifier: Apache-2.0
// servo/loop/contact_stability.hpp: was the contact quiet, slightly active or unstable? Judged from the records of a
// run.
//
// Only the last of the three verdicts on a sampled wall is a fault:
//   quiet            no contact gave more energy than it had taken.
//   slightly active  a contact did, by a bounded amount, and the tool came to rest. Every sampled wall with less
//                    damping than K T / 2 does so (Colgate and Schenkel 1997), and the hand and the device absorb it.
//                    So does an edit under the tool, and a field whose normals are not those of its surface.
//   unstable         the tool swings against the surface and does not settle, and the surface feeds the swing: a limit
//                    cycle or growth.
//
// Energy, by contact. A contact lasts from the first tick with contact or force until both are over. What it gave is
// how far E (passivity.hpp) fell below its value at the start. What it stored is how far E rose above it. A contact is
// quiet if it gave no more than the sum of two parts: kQuietShare of the most that any contact of the run stored, and
// the encoders' error. That error is Delta times the sum of the force's changes along each axis.
//
// Swings: servo/loop/swing_watch.hpp says which are those of an unstable contact. A contact that the servo has ended
// for it was unstable, too.
//
// Frame W: world [m, N]. Thread: any, after the run. Cost: one pass over the records. Errors: none.
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "servo/devices/path.hpp"
#include "servo/loop/tick_record.hpp"

namespace palpate {

enum class ContactVerdict { kNoContact, kQuiet, kSlightlyActive, kUnstable };

// Where the energy of a slightly active contact comes from, as far as the conditions of the run tell.
enum class ActivitySource { kNone, kEdits, kSampledWall, kField };

struct ContactConditions {
  double resolution_m = 0;      // of the device's encoders [m]
  int delay_ticks = 0;          // of the device's force
  double lacking_Ns_per_m = 0;  // K T / 2 + K T delay, less the wall's damping; 0 or less: enough damping [N s/m]
  double damping_Ns_per_m = 0;  // of the wall
  double most_damping_Ns_per_m = std::numeric_limits<double>::infinity();  // that some wall bears; infinite: unknown
  const Path* path = nullptr;  // where the hand wanted the tool; null: unknown
};

struct ContactStability {
  ContactVerdict verdict = ContactVerdict::kNoContact;
  ActivitySource source = ActivitySource::kNone;  // of given_J; kNone if no contact gave too much
  // For the contact that gave most beyond its error; if all are quiet, for the one that gave most:
  double given_J = 0;    // energy beyond what it had taken
  double error_J = 0;    // the most of it that the encoders can account for
  double stored_J = 0;   // the most that any contact of the run had taken at once
  double share = 0;      // given / stored; 0 where nothing was stored [-]
  double allowed_J = 0;  // error and quiet share, summed over all contacts
  int delay_ticks = 0;   // of the device's force, which lends to both
  // The damping that some wall bears at most [N s/m]; infinite: unknown. And whether the contact had more.
  double most_damping_Ns_per_m = std::numeric_limits<double>::infinity();
  bool damps_too_much = false;
  // For the swings:
  int bounces = 0;              // how often contact was left outwards while the hand wanted the tool inside
  double swing_m = 0;           // mean height of the swings that were judged unstable; the largest such mean [m]
  double swing_hz = 0;          // two swings are a period [1/s]
  double unstable_from_s = -1;  // start of the first of them [s]; -1: none
  double unstable_to_s = -1;    // end of the last
  int ended_by_servo = 0;       // how often the servo took the force away for it (instability_guard.hpp)

  static constexpr double kQuietShare = 0.01;
};

[[nodiscard]] ContactStability assessContact(std::span<const TickRecord> records, const ContactConditions& conditions);

// "no-contact", "quiet", "slightly-active", "unstable".
[[nodiscard]] const char* name(ContactVerdict verdict) noexcept;
// "none", "edits", "sampled-wall", "field".
[[nodiscard]] const char* name(ActivitySource source) noexcept;

}  // namespace palpate
