// SPDX-License-Identifier: Apache-2.0
#include "servo/objects/object_contacts.hpp"

#include <algorithm>
#include <cmath>

#include "servo/objects/closest_in_planes.hpp"

namespace palpate {
namespace {

constexpr double kAtRest_m = 1e-10;  // a VHIP that moves less has arrived
constexpr double kTurned_m = 1e-9;   // a plane of a curved object that is off the goal by less needs no new goal

ContactPlane standOff(const ObjectPoint& at) noexcept {
  return {at.p_W + ObjectContacts::kStandOff_m * at.normal_W, at.normal_W, 0};
}

}  // namespace

void ObjectContacts::Planes::add(const ContactPlane& plane, const ContactObject* owner) noexcept {
  planes[size()] = plane;
  owners[size()] = owner;
  ++count;
}

std::span<const ContactPlane> ObjectContacts::Planes::ofObjects() const noexcept {
  const std::size_t first = count > 0 && owners[0] == nullptr ? 1 : 0;
  return all().subspan(first);
}

bool ObjectContacts::onVolume() const noexcept {
  const auto* owners = trial_.planes.owners.data();
  return std::all_of(owners, owners + trial_.planes.count,
                     [&](const ContactObject* owner) { return owner == nullptr || owner == isosurface_; });
}

double ObjectContacts::sharpest(const Vec3& normal_W) const noexcept {
  double sine = 1;
  for (const ContactPlane& plane : trial_.planes.ofObjects())
    sine = std::min(sine, normal_W.cross(plane.normal_W).norm());
  return sine;
}

void ObjectContacts::reset(const Vec3& hip_W) noexcept {
  vhip_W_ = last_hip_W_ = hip_W;
  trial_ = {};
  trial_.vhip_W = hip_W;
}

// The first entry into any object on a line.
ObjectContacts::Sweep ObjectContacts::firstEntry(const Vec3& from_W, const Vec3& to_W) const noexcept {
  Sweep first;
  const Vec3 way_W = to_W - from_W;
  const double way_m = way_W.norm();
  if (!(way_m > kAtRest_m)) return first;
  constexpr double kBefore_m = 2 * kStandOff_m;
  const Vec3 before_W = from_W - way_W * (kBefore_m / way_m);
  for (const auto& object : objects_) {
    // Not for a sheet: a line that begins before it would enter it from its other side.
    const bool solid = object->solid();
    const auto entry = object->firstEntry(solid ? before_W : from_W, to_W);
    if (!entry) continue;
    const double at_m = solid ? entry->share * (way_m + kBefore_m) - kBefore_m : entry->share * way_m;
    if (first.object == nullptr || at_m < first.way_m) first = {at_m, object.get(), entry->at};
  }
  return first;
}

// The point nearest to the HIP in front of all planes. The planes of curved objects are moved to be under that point.
Vec3 ObjectContacts::goalOf(Planes& planes, const Vec3& hip_W) const noexcept {
  Vec3 goal_W = closestInPlanes(planes.all(), hip_W);
  for (int turn = 0; turn < kMaxTurns; ++turn) {
    bool turned = false;
    for (std::size_t i = 0; i < planes.size(); ++i) {
      if (planes.owners[i] == nullptr || !planes.owners[i]->curved()) continue;
      const ContactPlane plane = standOff(planes.owners[i]->nearest(goal_W));
      if (!(plane.depth(hip_W) > 0)) continue;
      turned = turned || std::abs(plane.depth(goal_W)) > kTurned_m;
      planes.planes[i] = plane;
    }
    if (!turned) break;
    goal_W = closestInPlanes(planes.all(), hip_W);
  }
  return goal_W;
}

// From `from` as far towards the HIP as the given planes and the objects allow. The planes that it meets are added.
Vec3 ObjectContacts::slide(const Vec3& from_W, const Vec3& hip_W, Planes& planes) const noexcept {
  Vec3 goal_W = closestInPlanes(planes.all(), hip_W);
  for (;;) {
    const Sweep met = firstEntry(from_W, goal_W);
    if (met.object == nullptr) return goal_W;
    if (planes.full()) {  // no goal can be reached: goes as far as the line is free
      const Vec3 way_W = goal_W - from_W;
      return from_W + way_W * (std::max(0.0, met.way_m - kStandOff_m) / way_W.norm());
    }
    planes.add(standOff(met.at), met.object);
    goal_W = goalOf(planes, hip_W);
  }
}

void ObjectContacts::runTrial(const Vec3& hip_W, const ContactPlane* volume) noexcept {
  trial_.vhip_W = vhip_W_;
  trial_.has_volume = volume != nullptr;
  if (volume != nullptr) trial_.volume = *volume;
  const int given = volume != nullptr ? 1 : 0;
  for (int i = 0; i < kMaxSlides; ++i) {
    const Vec3 from_W = trial_.vhip_W;
    trial_.planes.count = 0;
    if (volume != nullptr) trial_.planes.add(*volume, nullptr);
    trial_.vhip_W = slide(from_W, hip_W, trial_.planes);
    trial_.objects = trial_.planes.count - given;
    if (trial_.objects == 0 || (trial_.vhip_W - from_W).squaredNorm() < kAtRest_m * kAtRest_m) break;
  }
}

Vec3 ObjectContacts::volumeTool(const Vec3& hip_W, const ContactPlane* volume, const ContactPlane* found) noexcept {
  runTrial(hip_W, volume);
  if (trial_.objects == 0) return hip_W;
  if (volume == nullptr) return trial_.vhip_W;
  const double depth_m = volume->depth(closestInPlanes(trial_.planes.ofObjects(), hip_W));
  if (!(depth_m > 0)) return trial_.vhip_W;
  if (found == nullptr) found = volume;
  return found->nearest(trial_.vhip_W) - depth_m * found->normal_W;
}

// On the straight line from the VHIP as far as it is free, and no farther than that.
Vec3 ObjectContacts::towards(const Vec3& goal_W, double longest_m) const noexcept {
  const Vec3 way_W = goal_W - vhip_W_;
  const double way_m = way_W.norm();
  if (!(way_m > longest_m)) return goal_W;
  const Vec3 to_W = vhip_W_ + way_W * (longest_m / way_m);
  const Sweep met = firstEntry(vhip_W_, to_W);
  return met.object == nullptr ? to_W : Vec3(vhip_W_ + way_W * (std::max(0.0, met.way_m - kStandOff_m) / way_m));
}

std::optional<ContactPlane> ObjectContacts::settle(const Vec3& hip_W, const ContactPlane* volume,
                                                   double slack_m) noexcept {
  const bool same =
      (volume != nullptr) == trial_.has_volume &&
      (volume == nullptr || (volume->p_W == trial_.volume.p_W && volume->normal_W == trial_.volume.normal_W));
  if (!same) runTrial(hip_W, volume);
  const bool groove = volume != nullptr && trial_.objects > 0;
  vhip_W_ = groove ? towards(trial_.vhip_W, (hip_W - last_hip_W_).norm() + slack_m) : trial_.vhip_W;
  last_hip_W_ = hip_W;
  if (trial_.objects == 0) return volume != nullptr ? std::optional(*volume) : std::nullopt;
  const Vec3 push_W = vhip_W_ - hip_W;
  const double push_m = push_W.norm();
  if (!(push_m > 0)) return std::nullopt;
  return ContactPlane{vhip_W_, push_W / push_m, volume != nullptr ? volume->age_ticks : 0};
}

}  // namespace palpate
