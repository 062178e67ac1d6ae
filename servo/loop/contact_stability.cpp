// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/contact_stability.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <utility>
#include <vector>

#include "base/vec.hpp"
#include "servo/loop/run_figures.hpp"
#include "servo/safety/faults.hpp"
#include "servo/safety/passivity.hpp"

namespace palpate {
namespace {

// ---- energy ----

struct ContactEnergy {
  double given_J = 0, stored_J = 0, error_J = 0;
  bool edited = false;  // the volume was edited meanwhile
};

std::vector<ContactEnergy> contactEnergies(std::span<const TickRecord> records, const ContactConditions& conditions) {
  std::vector<ContactEnergy> contacts;
  bool open = false;
  double begin_J = 0;
  int idle_ticks = 0;
  std::uint64_t edit_version = records.empty() ? 0 : records.front().edit_version;
  Vec3 last_W = Vec3::Zero();
  for (const TickRecord& record : records) {
    const Vec3 force_W = asVec3(record.force_W);
    const bool acts = record.in_contact || !force_W.isZero(0);
    const bool edited = std::exchange(edit_version, record.edit_version) != record.edit_version;
    if (acts && !open) {
      contacts.emplace_back();
      begin_J = record.energy_J;
    }
    open = acts || open;
    if (!open) continue;
    ContactEnergy& contact = contacts.back();
    contact.edited = contact.edited || edited;
    contact.given_J = std::max(contact.given_J, begin_J - record.energy_J);
    contact.stored_J = std::max(contact.stored_J, record.energy_J - begin_J);
    contact.error_J += conditions.resolution_m * (force_W - last_W).lpNorm<1>();
    last_W = force_W;
    // The last force acts until the next tick, and with a delay of the device for that much longer.
    idle_ticks = acts ? 0 : idle_ticks + 1;
    open = idle_ticks <= conditions.delay_ticks;
  }
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

// ---- swings ----

// A turn of the height: running sums up to it.
struct Turn {
  double time_s = 0, height_m = 0, energy_J = 0;
  double path_m = 0;   // motion of the path along the normal
  double asked_m = 0;  // motion of path, surface and effects along the normal
  int bounces = 0;
};

class Swings {
 public:
  Swings(const ContactConditions& conditions, ContactStability& out)
      : conditions_(conditions),
        out_(out),
        least_m_(
            std::max(ContactStability::kLeastSwing_m, ContactStability::kLeastSwing_steps * conditions.resolution_m)) {}

  void add(const TickRecord& now) {
    const Vec3 hip_W = asVec3(now.hip_W), surface_W = surfacePointOf(now), normal_W = asVec3(now.normal_W);
    const Vec3 path_W = conditions_.path != nullptr ? conditions_.path->position(now.time_s) : hip_W;
    const bool contact = now.in_contact && !normal_W.isZero(0);
    if (has_plane_) {
      const double path_m = conditions_.path != nullptr ? std::abs(normal_W_.dot(path_W - path_before_W_)) : 0;
      path_m_ += path_m;
      asked_m_ += path_m;
      if (contact) asked_m_ += std::abs(normal_W_.dot(surface_W - plane_W_)) + effectMotion(now);
    }
    path_before_W_ = path_W;
    if ((now.faults & kFadingFaults) != 0) return forget();
    if (contact) {
      plane_W_ = surface_W;
      normal_W_ = normal_W;
      effect_height_m_ = effectHeight(now);
      depth_m_ = now.depth_m;
      has_plane_ = true;
      left_s_ = now.time_s;
    }
    if (!has_plane_) return;
    const double height_m = normal_W_.dot(hip_W - plane_W_);
    if (in_contact_ && !contact) countBounce(height_m, normal_W_.dot(path_W - plane_W_));
    in_contact_ = contact;
    const bool surface_ended = !contact && height_m < -least_m_;
    if (surface_ended || now.time_s - left_s_ > ContactStability::kLongestFlight_s) return forget();
    follow({now.time_s, height_m, now.energy_J, path_m_, asked_m_, out_.bounces});
  }

 private:
  // How far effects move the VHIP out of the surface, along the normal.
  static double effectHeight(const TickRecord& record) {
    return asVec3(record.normal_W).dot(asVec3(record.vhip_W) - surfacePointOf(record));
  }

  // The change of that height since the last tick in contact, without the part that is in proportion to the depth.
  [[nodiscard]] double effectMotion(const TickRecord& now) const {
    const double in_proportion_m = depth_m_ > 0 ? effect_height_m_ * now.depth_m / depth_m_ : 0;
    return std::min(std::abs(effectHeight(now) - effect_height_m_), std::abs(effectHeight(now) - in_proportion_m));
  }

  void forget() {
    has_plane_ = in_contact_ = turned_ = false;
    direction_ = 0;
    turns_.clear();
  }

  // A bounce: contact is left outwards while the path is inside. An unknown path is taken to be where the tool is.
  void countBounce(double height_m, double path_height_m) {
    if (height_m >= 0 && path_height_m < -2 * conditions_.resolution_m) ++out_.bounces;
  }

  // Finds turns of the height. Changes below the least swing make no turn.
  void follow(const Turn& now) {
    if (direction_ == 0) {
      direction_ = 1;
      farthest_ = now;
    } else if (direction_ * (now.height_m - farthest_.height_m) >= 0) {
      farthest_ = now;
    } else if (std::abs(now.height_m - farthest_.height_m) > least_m_) {
      if (turned_) turns_.push_back(farthest_);  // the first one may be where the record begins, not a turn
      turned_ = true;
      if (turns_.size() > ContactStability::kSwings + 1) turns_.pop_front();
      judge();
      direction_ = -direction_;
      farthest_ = now;
    }
  }

  void judge() {
    constexpr int kSwings = ContactStability::kSwings;
    if (turns_.size() <= kSwings) return;
    double first_m = 0, last_m = 0;
    for (std::size_t i = 0; i < kSwings; ++i) {
      (i < kSwings / 2 ? first_m : last_m) += std::abs(turns_[i + 1].height_m - turns_[i].height_m);
    }
    const Turn &begin = turns_.front(), &end = turns_.back();
    constexpr int kPeriods = kSwings / 2;
    const double hz = kPeriods / (end.time_s - begin.time_s);
    const bool sustained = last_m >= ContactStability::kSustained * first_m;
    const double unasked_m = (first_m + last_m) / ContactStability::kUnasked;
    const bool unasked =
        unasked_m > end.asked_m - begin.asked_m && (conditions_.path != nullptr || hz > ContactStability::kHand_hz);
    const bool bounced = end.bounces - begin.bounces >= kSwings / 2 && unasked_m > end.path_m - begin.path_m;
    const bool fed = end.energy_J < begin.energy_J - Passivity::kRounding_J;
    if (!sustained || !(unasked || bounced) || !fed) return;
    if (out_.verdict != ContactVerdict::kUnstable) out_.unstable_from_s = begin.time_s;
    out_.verdict = ContactVerdict::kUnstable;
    out_.unstable_to_s = end.time_s;
    if (const double mean_m = (first_m + last_m) / kSwings; mean_m > out_.swing_m) {
      out_.swing_m = mean_m;
      out_.swing_hz = hz;
    }
  }

  const ContactConditions& conditions_;
  ContactStability& out_;
  double least_m_;
  Vec3 plane_W_ = Vec3::Zero(), normal_W_ = Vec3::Zero();  // of the last tick in contact
  Vec3 path_before_W_ = Vec3::Zero();
  bool has_plane_ = false, in_contact_ = false;
  double effect_height_m_ = 0, depth_m_ = 0;  // of the last tick in contact
  double left_s_ = 0;                         // its time
  double path_m_ = 0, asked_m_ = 0;
  bool turned_ = false;
  int direction_ = 0;  // of the present swing: 1 up, -1 down, 0 none yet
  Turn farthest_;      // the farthest point of the present swing
  std::deque<Turn> turns_;
};

}  // namespace

ContactStability assessContact(std::span<const TickRecord> records, const ContactConditions& conditions) {
  ContactStability out;
  addEnergy(records, conditions, out);
  Swings swings(conditions, out);
  for (const TickRecord& record : records) swings.add(record);
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
