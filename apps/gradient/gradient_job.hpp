// SPDX-License-Identifier: Apache-2.0
// apps/gradient/gradient_job.hpp: `palpate gradient`: the gradients of a volume, computed on Vulkan, as an OpenVDB file
// of vectors (engine/volume/vector_file.hpp): of the bricks that the isosurface needs, or of all.
//
// The file is there whole or not at all. One thread. Cost: loading, the gradients (docs/gradients.md), 12 bytes of
// memory a voxel with a gradient, and writing.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "apps/console/progress.hpp"
#include "base/vec.hpp"

namespace palpate {

struct GradientRequest {
  std::string in;                       // as loadVolume takes it
  std::string out;                      // ends in .vdb
  std::string gradient = "central";     // engine/gradient/gradient_operator.hpp
  bool all = false;                     // every brick, not those alone that the isosurface needs
  std::optional<double> isovalue = {};  // empty: as `palpate touch` chooses it [density]
  std::string gpu = {};                 // part of the device's name; empty: the best one
};

struct GradientResult {
  std::string device;
  std::size_t bricks = 0;   // of the volume
  std::size_t written = 0;  // of them, with gradients
  double isovalue = 0;      // unless `all` [density]
  double gradient_s = 0;    // smoothing and gradients, the driver's compiler included
  double seconds = 0;       // loading, writing and all
  std::uint64_t bytes = 0;  // of the file
};

// Throws Error: kBadInput for an operator that is none, another suffix, an isovalue beside `all` or outside the
// volume's densities, an output that is the input; kCancelled on Ctrl-C; and what loadVolume, FilterChain and
// AtomicFile throw. What was at `out` stays then.
[[nodiscard]] GradientResult gradientFile(const GradientRequest& request, Progress& progress);

// A line for people.
[[nodiscard]] std::string gradientWords(const GradientRequest& request, const GradientResult& result);

}  // namespace palpate
