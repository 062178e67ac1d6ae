// SPDX-License-Identifier: Apache-2.0
// servo/objects/object_contacts.hpp: where objects and the volume's virtual plane together hold the tool.
//
// This is the god-object of Zilles and Salisbury (1995), with the volume's plane as one more constraint. The VHIP stays
// outside all objects. It goes straight towards the HIP until it enters an object. Then that object's plane is added.
// The point nearest to the HIP in front of all planes is the new goal (closest_in_planes.hpp), and the straight line to
// it is tried. When a line is free, the VHIP takes it. That is one slide. The VHIP then tries again from there without
// the planes that it met, so it goes over an edge in the tick in which it reaches the edge. Each slide brings it nearer
// to the HIP, so they end; kMaxSlides ends them sooner.
//
// In each tick, volume and objects see each other through two calls, in this order:
// 1. volumeTool() gives the tool position for which the volume has to find its plane. With no object in the way it is
//    the HIP. Against objects it lies behind the place where all planes together hold the tool. Its depth behind the
//    volume's plane is the depth that the objects alone would allow. So the volume's plane follows the VHIP, not a HIP
//    that is elsewhere. An object inside the bone is not touched while the bone's plane is in front of it.
// 2. settle() gives the VHIP with the plane that the volume found for that position.
// An object's plane lies kStandOff_m in front of its surface, so that rounding never puts the VHIP inside. Searches
// begin 2 kStandOff_m before the start of the line, so that a VHIP that did get a little inside is still held. If
// planes leave no room, the objects win: the VHIP never enters an object, and the volume's plane is violated.
//
// Frame W: world [m]. Thread: the servo's; no heap, lock, system call or throw after the constructor. Cost, in searches
// of one line through all objects: one without contact, three in steady contact with one object, at most kMaxSlides
// (kMaxPlanes + 1).
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "servo/contact/contact_plane.hpp"
#include "servo/objects/contact_object.hpp"

namespace palpate {

using ContactObjects = std::vector<std::shared_ptr<const ContactObject>>;

class ObjectContacts {
 public:
  static constexpr double kStandOff_m = 1e-6;
  static constexpr int kMaxSlides = 4;
  static constexpr int kMaxPlanes = 6;  // candidates; at most three are active (closest_in_planes.hpp)
  static constexpr int kMaxTurns = 4;   // per goal: how often planes of curved objects are moved to be under it

  // `isosurface`: which of the objects is the volume's own surface, if any.
  explicit ObjectContacts(ContactObjects objects, const ContactObject* isosurface = nullptr)
      : objects_(std::move(objects)), isosurface_(isosurface) {}
  [[nodiscard]] bool empty() const noexcept { return objects_.empty(); }

  // Puts the VHIP at the HIP. A tool that starts inside an object feels nothing of it until it has been outside once.
  void reset(const Vec3& hip_W) noexcept;

  // The tool position for which the volume has to find its plane. `volume`: the plane that objects met in the last
  // tick; null without contact. `found`: the plane that the volume itself had found; null: the same.
  [[nodiscard]] Vec3 volumeTool(const Vec3& hip_W, const ContactPlane* volume,
                                const ContactPlane* found = nullptr) noexcept;

  // Moves the VHIP. Gives one plane for all contacts together: through the VHIP, with the normal from the HIP to the
  // VHIP and the age of the volume's plane. If the volume alone is touched, it is `volume`; without contact there is
  // none. Call it once after each volumeTool(), with the same HIP.
  // In a groove between volume and objects the VHIP moves by at most the HIP's way and `slack_m`: there a small turn of
  // the volume's plane moves the place where they meet far.
  [[nodiscard]] std::optional<ContactPlane> settle(const Vec3& hip_W, const ContactPlane* volume,
                                                   double slack_m = std::numeric_limits<double>::infinity()) noexcept;

  [[nodiscard]] const Vec3& vhip_W() const noexcept { return vhip_W_; }
  // About the last settle(). singlePlane(): the VHIP met just one plane. onVolume(): it met no object other than the
  // volume's own surface.
  [[nodiscard]] bool singlePlane() const noexcept { return trial_.planes.count == 1; }
  [[nodiscard]] bool onVolume() const noexcept;
  // The sine of the sharpest groove between a plane and those of objects that the VHIP met last; 1 without these.
  [[nodiscard]] double sharpest(const Vec3& normal_W) const noexcept;
  // How many planes of objects the VHIP met in the last tick.
  [[nodiscard]] int objectPlanes() const noexcept { return trial_.objects; }

 private:
  // Planes met: the volume's first, if it is in contact, then the objects'.
  struct Planes {
    std::array<ContactPlane, kMaxPlanes> planes;
    std::array<const ContactObject*, kMaxPlanes> owners = {};
    int count = 0;
    [[nodiscard]] bool full() const noexcept { return count == kMaxPlanes; }
    void add(const ContactPlane& plane, const ContactObject* owner) noexcept;
    [[nodiscard]] std::span<const ContactPlane> all() const noexcept { return {planes.data(), size()}; }
    [[nodiscard]] std::span<const ContactPlane> ofObjects() const noexcept;
    [[nodiscard]] std::size_t size() const noexcept { return static_cast<std::size_t>(count); }
  };
  struct Trial {
    Vec3 vhip_W = Vec3::Zero();
    Planes planes;    // of the last slide
    int objects = 0;  // how many of them are planes of objects
    bool has_volume = false;
    ContactPlane volume;
  };
  struct Sweep {
    double way_m = 0;  // length of the line up to the entry
    const ContactObject* object = nullptr;
    ObjectPoint at;
  };

  // Moves a VHIP on trial. Fills trial_ in place, since copying its planes would cost more than a query.
  void runTrial(const Vec3& hip_W, const ContactPlane* volume) noexcept;
  [[nodiscard]] Vec3 slide(const Vec3& from_W, const Vec3& hip_W, Planes& planes) const noexcept;
  [[nodiscard]] Vec3 goalOf(Planes& planes, const Vec3& hip_W) const noexcept;
  [[nodiscard]] Sweep firstEntry(const Vec3& from_W, const Vec3& to_W) const noexcept;
  [[nodiscard]] Vec3 towards(const Vec3& goal_W, double longest_m) const noexcept;

  ContactObjects objects_;
  const ContactObject* isosurface_;
  Vec3 vhip_W_ = Vec3::Zero();
  Vec3 last_hip_W_ = Vec3::Zero();  // of the last settle()
  Trial trial_;                     // of this tick; after volumeTool() with the volume's plane of the last tick
};

}  // namespace palpate
