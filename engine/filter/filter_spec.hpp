// SPDX-License-Identifier: Apache-2.0
// engine/filter/filter_spec.hpp: filters as a user names them: "median:1 gaussian:0.8mm close:1". Any thread.
//
// A filter is NAME:SIZE[:KEY=VALUE]... A size is in voxels, or a length with its unit (mm, um, cm, m). If voxels are
// not cubes, a length gives each axis its own number of voxels. The size of a diffusion is its number of steps, that of
// a distance the half width of its band in voxels; both are whole numbers.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

enum class FilterKind {
  kGaussian,   // low-pass; size: sigma
  kBilateral,  // low-pass that keeps edges of density; size: sigma in space
  kDiffuse,    // anisotropic diffusion (Perona and Malik 1990); size: steps
  kDistance,   // signed distance from the isosurface, positive in the object [m]; size: half width of its band [voxel]
  kMedian,     // middle value of a box; size: its reach from the middle
  kDilate,     // highest value of a box or ball; size: its reach from the middle
  kErode,      // lowest value of a box or ball; size: its reach from the middle
  kOpen,       // erode, then dilate: removes parts of the object into which the shape does not fit
  kClose       // dilate, then erode: fills gaps into which the shape does not fit
};

// What a filter reads beyond the volume's border.
enum class Border {
  kNearest,  // the outermost voxel again: d d d | d c b
  kMirror    // the volume mirrored at its border: b c d | d c b
};

// How the conductance of a diffusion falls off with the slope s of the density, counted in multiples of kappa (Perona
// and Malik).
enum class Conductance {
  kRational,  // 1 / (1 + s^2)
  kExp        // exp(-s^2)
};

// Shape of a neighbourhood of size r. It holds the voxels whose centres are at most r away:
enum class WindowShape {
  kBox,  // along each axis
  kBall  // in a straight line; measured in metres if r is a length, else in voxels
};

// A number of voxels, or a length.
struct Extent {
  double value = 0;
  bool in_metres = false;
  [[nodiscard]] double voxels(double spacing_m) const noexcept { return in_metres ? value / spacing_m : value; }
};

struct FilterSpec {
  FilterKind kind = FilterKind::kGaussian;
  Extent size;
  Border border = Border::kNearest;
  double truncate = 3;           // gaussian, bilateral: reach of the kernel in sigmas; default 3, bilateral 2 [-]
  double range = 0;              // bilateral: sigma in density [density]
  double kappa = 0;              // diffuse: slope where conductance is 1/2 (rational) or 1/e (exp) [density / mm]
  std::optional<double> dt_mm2;  // diffuse: time step [mm^2]; empty: half of stableTimeStep()
  Conductance conductance = Conductance::kRational;
  WindowShape shape = WindowShape::kBox;  // dilate, erode, open, close
};

inline constexpr int kMostDiffusionSteps = 500;
inline constexpr int kWidestBand = 6;  // [voxel]; so a distance reads no farther than one brick's edge

// One row for each filter, for help texts and documentation.
struct FilterWords {
  std::string_view name, size, keys, what;
};
[[nodiscard]] std::span<const FilterWords> filterTable() noexcept;

// Parses a chain: filters separated by blanks. Throws Error(kBadInput) that says what is wrong and what may be given.
[[nodiscard]] std::vector<FilterSpec> filterChain(const std::string& text);

[[nodiscard]] std::string_view filterName(FilterKind kind) noexcept;

// Whether the chain holds a distance, which needs an isovalue.
[[nodiscard]] bool hasDistance(std::span<const FilterSpec> chain) noexcept;
// The isovalue of the chain's result: 0 after a distance, otherwise `isovalue`, that of the chain's input.
[[nodiscard]] float isovalueAfter(std::span<const FilterSpec> chain, float isovalue) noexcept;

}  // namespace palpate
