// SPDX-License-Identifier: Apache-2.0
// engine/filter/filter_spec.hpp: filters as a person asks for them: "median:1 gaussian:0.8mm close:1". Any thread.
//
// A filter is a word and a size, then keys: NAME:SIZE[:KEY=VALUE]... A size is in voxels, or a length with its unit
// (mm, um, cm, m); where voxels are not cubes a length gives each axis its own number of voxels. Steps of a diffusion
// and the band of a distance are whole numbers.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

enum class FilterKind {
  kGaussian,   // low-pass; size: sigma
  kBilateral,  // low-pass that leaves steps of density standing; size: sigma in space
  kDiffuse,    // anisotropic diffusion (Perona and Malik 1990); size: steps
  kDistance,   // signed distance from the isosurface, positive in the object [m]; size: half width of its band [voxel]
  kMedian,     // the middle value of a box; size: how far it reaches
  kDilate,     // the highest value of a box or ball; size: how far it reaches
  kErode,      // the lowest
  kOpen,       // erode, then dilate: takes away what the shape does not fit into
  kClose       // dilate, then erode: fills what the shape does not fit into
};

// What a filter reads beyond the volume's border.
enum class Border {
  kNearest,  // the outermost voxel again: d d d | d c b
  kMirror    // the volume mirrored at its border: b c d | d c b
};

// How diffusion falls off with the slope s, in multiples of kappa.
enum class Conductance {
  kRational,  // 1 / (1 + s^2)
  kExp        // exp(-s^2)
};

// What a window holds, of a given size r: voxels whose centre is at most r away
enum class WindowShape {
  kBox,  // along each axis
  kBall  // straight; in metres if r is a length, else in voxels
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
  double truncate = 3;           // gaussian (3), bilateral (2): the kernel ends at so many sigmas [-]
  double range = 0;              // bilateral: sigma in density [density]
  double kappa = 0;              // diffuse: the slope at which conductance is a half, or 1/e [density / mm]
  std::optional<double> dt_mm2;  // diffuse: time step [mm^2]; none: half of what is stable
  Conductance conductance = Conductance::kRational;
  WindowShape shape = WindowShape::kBox;  // dilate, erode, open, close
};

inline constexpr int kMostDiffusionSteps = 500;
inline constexpr int kWidestBand = 6;  // [voxel]: with what is read around it, the band stays within a brick's length

// One row for each word: for help texts and documentation.
struct FilterWords {
  std::string_view name, size, keys, what;
};
[[nodiscard]] std::span<const FilterWords> filterTable() noexcept;

// A chain, filters separated by blanks. Throws Error(kBadInput) with what is wrong and what may be given.
[[nodiscard]] std::vector<FilterSpec> filterChain(const std::string& text);

[[nodiscard]] std::string_view filterName(FilterKind kind) noexcept;

// Whether a chain needs an isovalue.
[[nodiscard]] bool hasDistance(std::span<const FilterSpec> chain) noexcept;
// The isovalue after a chain that began with `isovalue`: a distance moves the surface to 0.
[[nodiscard]] float isovalueAfter(std::span<const FilterSpec> chain, float isovalue) noexcept;

}  // namespace palpate
