// SPDX-License-Identifier: Apache-2.0
// apps/gradient/gradient_job.hpp: `palpate gradient`: computes the gradients of a volume on Vulkan, for the bricks that
// the isosurface needs or for all, and writes them as an OpenVDB file of vectors (engine/files/vector_file.hpp).
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
  bool all = false;                     // every brick, not only those that the isosurface needs
  std::optional<double> isovalue = {};  // empty: as `palpate touch` chooses it [density]
  std::string gpu = {};                 // part of the device's name; empty: the best one
};

struct GradientResult {
  std::string device;
  std::size_t bricks = 0;   // of the volume
  std::size_t written = 0;  // bricks with gradients
  double isovalue = 0;      // not set if `all` [density]
  double gradient_s = 0;    // smoothing and gradients, with the driver's compiler
  double seconds = 0;       // the whole job
  std::uint64_t bytes = 0;  // of the file
};

// Throws Error: kBadInput for an unknown operator, another suffix, an isovalue together with `all`, an isovalue outside
// the volume's densities, and an output that is the input; kCancelled on Ctrl-C; and as loadVolume, FilterChain and
// AtomicFile do. Then a file that was at `out` is unchanged.
[[nodiscard]] GradientResult gradientFile(const GradientRequest& request, Progress& progress);

// A line for people.
[[nodiscard]] std::string gradientWords(const GradientRequest& request, const GradientResult& result);

}  // namespace palpate
