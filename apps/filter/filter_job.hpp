// SPDX-License-Identifier: Apache-2.0
// apps/filter/filter_job.hpp: `palpate filter`: a volume through a chain of filters into another file.
//
// The file is there whole or not at all. Formats: engine/volume/volume_file.hpp. One thread. Cost: loading, the filters
// (docs/filters.md), and writing.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "apps/console/progress.hpp"
#include "base/vec.hpp"
#include "engine/filter/filter_spec.hpp"

namespace palpate {

struct FilterRequest {
  std::string in;                                 // as loadVolume takes it
  std::string out;                                // its suffix names the format
  std::string filter;                             // chain, as --filter takes it
  std::string gpu;                                // part of the device's name; empty: the best one
  std::optional<double> isovalue = std::nullopt;  // of a distance; none: the volume's default [density]
};

struct FilterResult {
  std::string device;
  Vec3i size = Vec3i::Zero();   // [voxel]
  std::size_t steps = 0;        // passes over the field
  Vec3i reach = Vec3i::Zero();  // how far densities are carried [voxel]
  std::size_t stored_before = 0, stored_after = 0, bricks = 0;
  float lowest = 0, highest = 0;  // of the result [density]
  std::optional<double> surface;  // isovalue of the surface in the result, where it is known; a .vdb keeps it [density]
  double filter_s = 0;            // of the filters, the driver's compiler included
  double seconds = 0;             // loading, writing and all
  std::uint64_t bytes = 0;        // of the file
};

// Throws Error: kBadInput for a chain that cannot be meant, an isovalue without a distance, an unknown suffix, an
// output that is the input; kCancelled on Ctrl-C; and what
// loadVolume, FilterChain and writeVolume throw. What was at `out` stays then.
[[nodiscard]] FilterResult filterFile(const FilterRequest& request, Progress& progress);

// Throws Error(kBadInput) where an isovalue was given for a chain without a distance, which has no use for it. `text`:
// the chain as it was given.
void checkIsovalueIsUsed(std::span<const FilterSpec> chain, const std::string& text);

// A line or two for people.
[[nodiscard]] std::string filterWords(const FilterRequest& request, const FilterResult& result);

}  // namespace palpate
