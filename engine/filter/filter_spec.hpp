// SPDX-License-Identifier: Apache-2.0
// engine/filter/filter_spec.hpp: filters as a person asks for them: "median:1 gaussian:0.8mm close:1". Any thread.
//
// A filter is a word and a size, then keys: NAME:SIZE[:KEY=VALUE]... A size is in voxels, or a length with its unit
// (mm, um, cm, m); where voxels are not cubes a length gives each axis its own number of voxels.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

enum class FilterKind {
  kGaussian,  // low-pass; size: sigma
};

// What a filter reads beyond the volume's border.
enum class Border {
  kNearest,  // the outermost voxel again: d d d | d c b
  kMirror    // the volume mirrored at its border: b c d | d c b
};

// So many voxels, or so long.
struct Extent {
  double value = 0;
  bool in_metres = false;
  [[nodiscard]] double voxels(double spacing_m) const noexcept { return in_metres ? value / spacing_m : value; }
};

struct FilterSpec {
  FilterKind kind = FilterKind::kGaussian;
  Extent size;
  Border border = Border::kNearest;
  double truncate = 3;  // gaussian: the kernel ends at so many sigmas [-]
};

// One row for each word: for help texts and documentation.
struct FilterWords {
  std::string_view name, size, keys, what;
};
[[nodiscard]] std::span<const FilterWords> filterTable() noexcept;

// A chain, filters separated by blanks. Throws Error(kBadInput) with what is wrong and what may be given.
[[nodiscard]] std::vector<FilterSpec> filterChain(const std::string& text);

}  // namespace palpate
