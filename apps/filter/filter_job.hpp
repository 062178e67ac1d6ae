// SPDX-License-Identifier: Apache-2.0
// apps/filter/filter_job.hpp: `palpate filter`: applies a chain of filters to a volume and writes the result.
//
// The file is there whole or not at all. Formats: engine/files/volume_file.hpp. One thread. Cost: loading, the filters
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
  std::optional<double> isovalue = std::nullopt;  // for a distance; empty: the volume's default [density]
};

struct FilterResult {
  std::string device;
  Vec3i size = Vec3i::Zero();   // [voxel]
  std::size_t steps = 0;        // passes over the field
  Vec3i reach = Vec3i::Zero();  // how far a density influences the result [voxel]
  std::size_t stored_before = 0, stored_after = 0, bricks = 0;
  float lowest = 0, highest = 0;  // of the result [density]
  std::optional<double> surface;  // isovalue of the surface in the result, if known; a .vdb keeps it [density]
  double filter_s = 0;            // time of the filters, with the driver's compiler
  double seconds = 0;             // the whole job
  std::uint64_t bytes = 0;        // of the file
};

// Throws Error: kBadInput for an invalid chain, an isovalue without a distance, an unknown suffix, and an output that
// is the input; kCancelled on Ctrl-C; and as loadVolume, FilterChain and writeVolume do. Then a file that was at `out`
// is unchanged.
[[nodiscard]] FilterResult filterFile(const FilterRequest& request, Progress& progress);

// For a given isovalue: throws Error(kBadInput) if the chain holds no distance, which alone uses it. `text`: the chain
// as it was given.
void checkIsovalueIsUsed(std::span<const FilterSpec> chain, const std::string& text);

// A line or two for people.
[[nodiscard]] std::string filterWords(const FilterRequest& request, const FilterResult& result);

}  // namespace palpate
