// SPDX-License-Identifier: Apache-2.0
// servo/objects/shapes.hpp: objects that a formula describes: half-space, ball, box.
//
// Frame W: world [m]. Thread and cost: contact_object.hpp; some 5 to 15 ns a query. Constructors throw Error(kBadInput)
// for numbers that are not finite, sizes that are not positive, a zero normal, and axes that are not orthonormal.
// `name` is the object's name in the message.
#pragma once

#include <string>

#include "servo/objects/contact_object.hpp"

namespace palpate {

// The half-space behind a plane.
class PlaneObject final : public ContactObject {
 public:
  PlaneObject(const Vec3& p_W, const Vec3& normal_W, const std::string& name = "plane");
  [[nodiscard]] std::optional<ObjectEntry> firstEntry(const Vec3& from_W, const Vec3& to_W) const noexcept override;
  [[nodiscard]] ObjectPoint nearest(const Vec3& x_W) const noexcept override;

 private:
  Vec3 p_W_, normal_W_;
};

class SphereObject final : public ContactObject {
 public:
  SphereObject(const Vec3& centre_W, double radius_m, const std::string& name = "sphere");
  [[nodiscard]] std::optional<ObjectEntry> firstEntry(const Vec3& from_W, const Vec3& to_W) const noexcept override;
  [[nodiscard]] ObjectPoint nearest(const Vec3& x_W) const noexcept override;
  [[nodiscard]] bool curved() const noexcept override { return true; }

 private:
  Vec3 centre_W_;
  double radius_m_;
};

class BoxObject final : public ContactObject {
 public:
  // `R_WB`: its columns are the directions of the box's edges; `size_m`: whole edges.
  BoxObject(const Vec3& centre_W, const Vec3& size_m, const Mat3& R_WB = Mat3::Identity(),
            const std::string& name = "box");
  [[nodiscard]] std::optional<ObjectEntry> firstEntry(const Vec3& from_W, const Vec3& to_W) const noexcept override;
  // If the nearest point lies on an edge or corner, the normal points from it to x.
  [[nodiscard]] ObjectPoint nearest(const Vec3& x_W) const noexcept override;

 private:
  Vec3 centre_W_, half_m_;
  Mat3 R_WB_;
};

}  // namespace palpate
