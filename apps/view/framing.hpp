// SPDX-License-Identifier: Apache-2.0
// apps/view/framing.hpp: chooses the two viewpoints of view.png: the whole object, and the contact from close by.
//
// World frame [m]. Set-up code, any thread. Cost: up to some 100000 samples of the field.
#pragma once

#include "apps/path/surface_field.hpp"
#include "apps/view/contact_region.hpp"
#include "base/camera.hpp"

namespace palpate {

// Centre and radius of the object in the volume, from samples on a grid of at most 24 along each axis; the volume's own
// where nothing of them is object.
struct ObjectBounds {
  Vec3 centre_W = Vec3::Zero();  // [m]
  double radius_m = 0;           // [m]
};
[[nodiscard]] ObjectBounds findObjectBounds(const SurfaceField& field);

// The whole object, from the side where it was touched and a little from above.
[[nodiscard]] Camera overviewCamera(const ObjectBounds& object, const ContactRegion& region, int width, int height);

// A region whose surface an edit has changed: its normal is then the mean of the directions in which nothing of the
// object is in the way from its points. In a groove the tool touches a front wall, whose normals point along the
// groove; out of it there is one way only. The normal stays where nothing is open.
void turnToTheOpen(ContactRegion& region, const SurfaceField& field);

// The contact seen obliquely, the slide from left to right and the normal upwards, so that the depth of the press and
// the force arrows show their length. Of several heights and both sides the one is taken from which the object hides
// least, but a low one rather than a slightly better high one.
[[nodiscard]] Camera closeUpCamera(const SurfaceField& field, const ContactRegion& region, int width, int height);

}  // namespace palpate
