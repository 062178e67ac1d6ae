// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/picture.hpp"

#include <algorithm>

#include "apps/view/compose_view.hpp"
#include "apps/view/contact_region.hpp"
#include "apps/view/framing.hpp"

namespace palpate {
namespace {

// A region of contact is shown with at least this much around it. [voxel]
constexpr double kLeastRegionVoxels = 10;
constexpr double kMostRegionShare = 0.6;  // of the object's size, if the object is only some voxels large

}  // namespace

std::string drawPicture(const TouchRun& run, const SurfaceField& surface, Engine& engine,
                        const std::function<void()>& between) {
  const ViewLayout layout = layOutView(run.scene.image_width, run.scene.image_height);
  const ObjectBounds object = findObjectBounds(surface);
  ContactRegion region = findContactRegion(
      run.records,
      std::min(kLeastRegionVoxels * surface.lattice().spacing_m.maxCoeff(), kMostRegionShare * object.radius_m));
  if (run.edits && run.edits->count > 0) turnToTheOpen(region, surface);
  ViewPictures pictures;
  pictures.overview_camera = overviewCamera(object, region, layout.overview.width, layout.overview.height);
  pictures.close_up_camera = closeUpCamera(surface, region, layout.close_up.width, layout.close_up.height);
  pictures.overview = engine.draw(pictures.overview_camera, between);
  pictures.close_up = engine.draw(pictures.close_up_camera, between);
  return composeView(layout, pictures, region, run, between);
}

}  // namespace palpate
