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
// Swings. The height of the HIP over the plane turns up and down; out of contact the last plane counts. A swing goes
// from one turn to the next. It counts if it is at least kLeastSwing_m and kLeastSwing_steps encoder steps high. (In a
// loop that is stable without rounding, rounding alone can keep up a swing of two steps.) The contact is unstable if
// all of this is true of kSwings successive swings:
// - They do not die away: the second half is at least kSustained of the first half. At kSwings = 20 a swing that loses
//   5.6 % a period, a damping ratio of 0.009, is on the border.
// - Neither the hand nor the surface asks for them. The heights of the swings add up to more than kUnasked times the
//   sum of three motions along the normal in the same time: that of the hand's path, that of the surface, and that of
//   what effects add to it. So a path that taps, a texture and a noisy surface do not count, unless the contact answers
//   with a resonance of more than that. What an effect adds in proportion to the depth is stiffness and asks for
//   nothing. If the path is unknown, only swings faster than kHand_hz count, since a hand can make slower ones.
//   Whatever the surface asks for, this is enough instead: the path alone does not ask for the swings, and in each
//   period the tool left the surface while the hand wanted it inside.
// - The surface fed them: E fell from the first to the last. So stick-slip does not count, since friction takes energy.
// Three events start the count anew: the surface ends under the tool (contact is lost with the HIP still below the
// plane), a fading fault, and half a second out of contact. A hand that is exactly on its path cannot bounce, since the
// HIP's height is the path's own.
//
// Frame W: world [m, N]. Thread: any, after the run. Cost: one pass over the records. Errors: none.
#pragma once

#include <cstdint>
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
  const Path* path = nullptr;   // where the hand wanted the tool; null: unknown
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
  // For the swings:
  int bounces = 0;              // how often contact was left outwards while the hand wanted the tool inside
  double swing_m = 0;           // mean height of the kSwings that were judged unstable; the largest such mean [m]
  double swing_hz = 0;          // two swings are a period [1/s]
  double unstable_from_s = -1;  // start of the first of them [s]; -1: none
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
