// SPDX-License-Identifier: Apache-2.0
// servo/objects/contact_object.hpp: a solid body beside the volume that the tool can touch.
//
// Frame W: world [m]. Normals point out of the object, as everywhere. Objects do not change once made. Thread: queries
// are const, from any thread; no heap, lock, system call or throw. Constructors throw for what an object refuses.
#pragma once

#include <optional>

#include "base/vec.hpp"

namespace palpate {

struct ObjectPoint {
  Vec3 p_W = Vec3::Zero();       // on the surface [m]
  Vec3 normal_W = Vec3::Zero();  // unit, out of the object [-]
};

struct ObjectEntry {
  double share = 0;  // of the line, at which it enters, 0 to 1 [-]
  ObjectPoint at;
};

class ContactObject {
 public:
  virtual ~ContactObject() = default;

  // The first place at which the straight line goes from outside to inside. A line that begins inside must come out
  // first. A line along the surface does not enter.
  [[nodiscard]] virtual std::optional<ObjectEntry> firstEntry(const Vec3& from_W, const Vec3& to_W) const noexcept = 0;

  // The surface point nearest to x, which may be inside or outside.
  [[nodiscard]] virtual ObjectPoint nearest(const Vec3& x_W) const noexcept = 0;

  // Whether the surface is smooth and curved. Then its plane is taken at the surface point nearest to the VHIP, not at
  // the entry.
  [[nodiscard]] virtual bool curved() const noexcept { return false; }

  // Whether there is an inside. A sheet has none and is entered from both sides.
  [[nodiscard]] virtual bool solid() const noexcept { return true; }
};

}  // namespace palpate
