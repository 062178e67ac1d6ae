// SPDX-License-Identifier: Apache-2.0
// apps/render/render_job.hpp: `palpate render`: draws the isosurface of a volume into files, without a display.
//
// Each file is there whole or not at all. It loads the volume, filters it if asked to, finds the bricks' bounds and
// draws; it computes no gradients. One thread. Cost: loading, the filters, and what docs/results/render.md says.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/console/progress.hpp"
#include "apps/render/picture_files.hpp"
#include "apps/render/render_request.hpp"
#include "base/camera.hpp"
#include "base/lattice.hpp"

namespace palpate {

// One frame.
struct Picture {
  PictureFiles files;
  Camera camera;
  std::size_t hit_pixels = 0;                // that show the first surface, a cut face or a slice
  double nearest_m = 0, farthest_m = 0;      // of them; 0: there are none [m]
  double draw_s = 0;                         // of drawing, with the driver's compiler in the first frame
  std::uint64_t bytes = 0, depth_bytes = 0;  // of the files
};

struct RenderResult {
  std::string device;
  Vec3i size = Vec3i::Zero();             // of the volume [voxel]
  WorldBox extent;                        // of the volume
  bool is_distance = false;               // the field that is drawn is a distance: its densities are metres
  double isovalue = 0;                    // of the field that is drawn [density]
  double lowest = 0, highest = 0;         // of that field [density]
  std::optional<SliceRange> slice_range;  // used; empty: no slices
  Vec3 target_W = Vec3::Zero();           // [m]
  double distance_m = 0;                  // from the camera to the target
  std::uint64_t gpu_bytes = 0;            // GPU memory in use at the end
  std::vector<Picture> pictures;
  double seconds = 0;  // the whole job

  // Behind a density: " m" for a distance.
  [[nodiscard]] const char* unit() const noexcept { return is_distance ? " m" : ""; }
};

// Throws Error: kBadInput for the files that checkPictureFiles() refuses, an invalid filter, planes that styleOf()
// refuses, an isovalue that gives no surface, a second one that is not below the first, a volume one voxel thick;
// kCancelled on Ctrl-C; and as checkPicturesWritable, loadVolume, BrickPool, FilterChain, Drawing and AtomicFile do.
// Files of frames that were finished before stay.
[[nodiscard]] RenderResult render(const RenderRequest& request, Progress& progress);

}  // namespace palpate
