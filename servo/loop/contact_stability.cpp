// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/contact_stability.hpp"

#include <algorithm>
#include <vector>

#include "servo/loop/contact_energy.hpp"
#include "servo/loop/swing_watch.hpp"
#include "servo/safety/faults.hpp"
#include "servo/safety/passivity.hpp"

namespace palpate {
namespace {

std::vector<ContactEnergy> contactEnergies(std::span<const TickRecord> records, const ContactConditions& conditions) {
  std::vector<ContactEnergy> contacts;
  ContactEnergyMeter meter(conditions.resolution_m, conditions.delay_ticks);
  for (const TickRecord& record : records) {
    if (meter.add(record)) contacts.push_back(meter.contact());
  }
  if (meter.open()) contacts.push_back(meter.contact());
  return contacts;
}

ActivitySource sourceOf(const ContactEnergy& contact, const ContactConditions& conditions) {
  if (contact.edited) return ActivitySource::kEdits;
  return conditions.lacking_Ns_per_m > 0 ? ActivitySource::kSampledWall : ActivitySource::kField;
}

void addEnergy(std::span<const TickRecord> records, const ContactConditions& conditions, ContactStability& out) {
  const std::vector<ContactEnergy> contacts = contactEnergies(records, conditions);
  if (contacts.empty()) return;
  for (const ContactEnergy& contact : contacts) out.stored_J = std::max(out.stored_J, contact.stored_J);
  const double quiet_J = ContactStability::kQuietShare * out.stored_J + Passivity::kRounding_J;
  const ContactEnergy* worst = &contacts.front();
  for (const ContactEnergy& contact : contacts) {
    out.allowed_J += quiet_J + contact.error_J;
    if (contact.given_J - contact.error_J > worst->given_J - worst->error_J) worst = &contact;
  }
  if (worst->given_J <= quiet_J + worst->error_J) {
    worst = &*std::max_element(contacts.begin(), contacts.end(),
                               [](const auto& a, const auto& b) { return a.given_J < b.given_J; });
  }
  out.given_J = worst->given_J;
  out.error_J = worst->error_J;
  out.share = out.stored_J > 0 ? out.given_J / out.stored_J : 0;
  out.verdict = out.given_J > quiet_J + out.error_J ? ContactVerdict::kSlightlyActive : ContactVerdict::kQuiet;
  if (out.verdict == ContactVerdict::kSlightlyActive) out.source = sourceOf(*worst, conditions);
}

void noteUnstable(const SwingWatch::Unstable& swings, ContactStability& out) {
  if (out.verdict != ContactVerdict::kUnstable) out.unstable_from_s = swings.from_s;
  out.verdict = ContactVerdict::kUnstable;
  out.unstable_to_s = swings.to_s;
  if (swings.swing_m <= out.swing_m) return;
  out.swing_m = swings.swing_m;
  out.swing_hz = swings.swing_hz;
}

}  // namespace

ContactStability assessContact(std::span<const TickRecord> records, const ContactConditions& conditions) {
  ContactStability out;
  out.delay_ticks = conditions.delay_ticks;
  out.most_damping_Ns_per_m = conditions.most_damping_Ns_per_m;
  out.damps_too_much = conditions.damping_Ns_per_m > conditions.most_damping_Ns_per_m;
  addEnergy(records, conditions, out);
  SwingWatch watch(conditions.resolution_m, conditions.path);
  SwingWatch guards(conditions.resolution_m);  // as the servo's guard saw it
  bool was_ended = false, guards_saw = false;
  for (const TickRecord& record : records) {
    if (watch.add(record)) noteUnstable(watch.unstable(), out);
    const bool is_ended = has(record.faults, ServoFault::kUnstable);
    if (is_ended && !was_ended) {
      ++out.ended_by_servo;
      noteUnstable(guards_saw ? guards.unstable() : SwingWatch::Unstable{record.time_s, record.time_s, 0, 0}, out);
    }
    was_ended = is_ended;
    guards_saw = guards.add(record);
  }
  out.bounces = watch.bounces();
  return out;
}

const char* name(ActivitySource source) noexcept {
  switch (source) {
    case ActivitySource::kEdits:
      return "edits";
    case ActivitySource::kSampledWall:
      return "sampled-wall";
    case ActivitySource::kField:
      return "field";
    default:
      return "none";
  }
}

const char* name(ContactVerdict verdict) noexcept {
  switch (verdict) {
    case ContactVerdict::kQuiet:
      return "quiet";
    case ContactVerdict::kSlightlyActive:
      return "slightly-active";
    case ContactVerdict::kUnstable:
      return "unstable";
    default:
      return "no-contact";
  }
}

}  // namespace palpate
