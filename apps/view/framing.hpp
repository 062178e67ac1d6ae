// SPDX-License-Identifier: Apache-2.0
// apps/view/framing.hpp: chooses the two viewpoints of view.png: the whole object, and the contact from close by.
//
// World frame [m]. Set-up code, any thread. Cost: up to some 100000 samples of the field.
#pragma once

#include "apps/path/surface_field.hpp"
#include "apps/view/contact_region.hpp"
#include "base/camera.hpp"

namespace palpate {

// A sphere around the object in the volume, from samples on a grid of at most 24 along each axis. If no sample is
// object, it is a sphere around the volume.
struct ObjectBounds {
  Vec3 centre_W = Vec3::Zero();  // [m]
  double radius_m = 0;           // [m]
};
[[nodiscard]] ObjectBounds findObjectBounds(const SurfaceField& field);

// The whole object, from the side where it was touched and a little from above.
[[nodiscard]] Camera overviewCamera(const ObjectBounds& object, const ContactRegion& region, int width, int height);

// For a region whose surface an edit has changed: sets its normal to the mean of the directions in which the object
// does not block the view from the region's points. (In a groove that the tool cuts, it touches the front wall, whose
// normals point along the groove; but the groove can be seen only from its open side.) Else keeps it.
void turnToTheOpen(ContactRegion& region, const SurfaceField& field);

// The contact seen obliquely, with the slide from left to right and the normal upwards, so that the depth of the press
// and the force arrows show their length. Of several heights and both sides, takes the view in which the object hides
// least, but prefers a low one to a slightly better high one.
[[nodiscard]] Camera closeUpCamera(const SurfaceField& field, const ContactRegion& region, int width, int height);

}  // namespace palpate
