// SPDX-License-Identifier: Apache-2.0
// engine/field/volume.hpp: a scalar field in space. It holds the authoritative densities, on the CPU, in an OpenVDB
// grid (engine/vdb). OpenVDB is loaded with the first volume that is made (base/module.hpp).
//
// Frames: I is the volume's index space [voxel]; the domain's first voxel is (0,0,0). lattice() maps I to the world W
// [m]. The field is defined on the domain [0, size) only. Bricks of 8x8x8 voxels tile the domain from (0,0,0); a stored
// brick is a VDB leaf. A brick whose voxels all hold one value is constant and has no storage.
// Thread: const functions from any thread while nobody changes the volume.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/lattice.hpp"

namespace palpate {

inline constexpr int kBrickSize = 8;                                       // voxels along a brick's edge
inline constexpr int kBrickVoxels = kBrickSize * kBrickSize * kBrickSize;  // 512

// The numbers of a file that no 32-bit float holds, so that the densities are others. A number that is scaled (slope
// and intercept, a level set's unit) counts with what scaling it in double gives; an integer that no double holds, in
// long double.
struct Rounding {
  std::uint64_t count = 0;  // voxels, or before a resampling pixels
  double most = 0;          // the largest change [density]
  std::string of;           // what was rounded: "int32", "scaled int16"; "": nothing
  // "12 of its int32 values are no 32-bit floats and were rounded, by 1 at most"; "": none was.
  [[nodiscard]] std::string words() const;
};

// Where a volume came from and what its numbers mean; shown by `palpate info` and kept in summaries.
struct VolumeFacts {
  std::string source;        // file or phantom name as the user gave it
  std::string format;        // "NRRD", "DICOM series", "phantom", ...
  std::string value_type;    // of the file: "int16", "float32", ...
  std::string orientation;   // words: "LPS axes", "RAS file turned to LPS", ...
  double rescale_slope = 1;  // file value * slope + intercept = density
  double rescale_intercept = 0;
  std::string rescale_in_words;  // the density, where a slope and an intercept for all do not say it; "": they do
  bool is_level_set = false;     // a VDB level set: density is minus the signed distance [m], isovalue 0
  std::optional<double> declared_isovalue;  // of a phantom: the density of its exact surface
  std::optional<double> kept_isovalue;  // at which it was sculpted, as its file says; NaN and any double are possible
  std::string part;                     // the part of a folder: "series 2 of 3: 1.2.3"; empty: the folder has no parts
  std::optional<float> instead_of_nan;  // used while reading: the density that replaces invalid values; empty: refuse
  Rounding rounded;                     // of the file's numbers, when they became densities
  std::uint64_t replaced = 0;           // voxels that have no density in the file (NaN, padding), and one here
  std::uint64_t clamped = 0;            // pixels that a lossy coding put beyond the bits which the file says it stores
  bool resampled = false;               // densities lie between those of the file (tilted slices made upright)
  std::string remark;                   // what a user should know: what was replaced or chosen; empty: nothing
};

class Volume {
 public:
  // Makes a volume from size.x * size.y * size.z dense values, i fastest. Throws Error(kBadInput) for a dimension below
  // 1, values that are not finite, or a bad lattice. Bricks that hold one value become constant. Cost: one pass on all
  // processors.
  static Volume fromDense(const Vec3i& size, const Lattice& lattice, const std::vector<float>& values,
                          VolumeFacts facts);

  // The same brick by brick, for volumes too large to be dense. `source` fills a brick's 512 densities (i fastest) and
  // returns false; for a constant brick it sets values[0] only and returns true. It is called once for every brick of
  // the domain, i fastest. Memory: the bricks that are not constant, and 8 bytes for each constant one.
  using BrickSource = std::function<bool(const Vec3i& brick, float* values)>;
  static Volume fromBricks(const Vec3i& size, const Lattice& lattice, VolumeFacts facts, const BrickSource& source);

  // The same on all processors. A LayerSource returns the source of one layer: the bricks (i, j, bk). One thread reads
  // a layer, i fastest; several threads read several layers at once.
  using LayerSource = std::function<BrickSource(int bk)>;
  static Volume fromLayers(const Vec3i& size, const Lattice& lattice, VolumeFacts facts, const LayerSource& layers);

  Volume(Volume&&) noexcept;
  Volume& operator=(Volume&&) noexcept;
  ~Volume();

  [[nodiscard]] const Vec3i& size() const noexcept;       // domain [voxel]
  [[nodiscard]] const Lattice& lattice() const noexcept;  // index space to world
  [[nodiscard]] const VolumeFacts& facts() const noexcept;
  [[nodiscard]] float minimum() const noexcept;  // over the domain [density]
  [[nodiscard]] float maximum() const noexcept;

  // One voxel; outside the domain, the nearest voxel inside. Slow (a tree walk): for reference code and tests.
  [[nodiscard]] float value(const Vec3i& index) const;

  // Bricks along each axis: ceil(size / 8).
  [[nodiscard]] Vec3i brickCount() const noexcept;
  // Fills `values` with a brick's 512 densities (i fastest) and returns false. For a constant brick it sets values[0]
  // only and returns true. Voxels of the brick outside the domain repeat the nearest voxel inside.
  bool readBrick(const Vec3i& brick, float* values) const;

  // Replaces one brick by 512 densities (i fastest, voxels outside the domain as readBrick gives them), or by one value
  // everywhere. Values must be finite. minimum() and maximum() are widened to include them, but never narrowed. Cost: a
  // tree walk and 2 KiB.
  // Thread: while nobody reads the volume.
  void setBrick(const Vec3i& brick, const float* values);
  void setConstantBrick(const Vec3i& brick, float value);

  // Notes the isovalue at which the volume was sculpted, for files that can keep it (.vdb).
  // Thread: as setBrick().
  void keepIsovalue(double isovalue) noexcept;
  // Sets facts().source, the name under which loadVolume finds the volume again.
  void rename(std::string source) noexcept;
  void remark(const std::string& words);         // added to VolumeFacts::remark
  void noteRounding(Rounding rounded) noexcept;  // sets facts().rounded, known once all bricks were read

  // The whole domain, i fastest. Memory: 4 bytes a voxel.
  [[nodiscard]] std::vector<float> toDense() const;

  // Trilinear density and central-difference gradient [density/m, world] at a world point, for set-up code such as path
  // building. The gradient is interpolated between voxels as the density is. On the domain's faces the difference is
  // one-sided; along an axis of one voxel it is 0. Returns false outside the box between the centres of the first and
  // the last voxel.
  bool sample(const Vec3& p_W, double& density, Vec3& gradient_W) const;
  // The same density alone, in a quarter of the time; empty where sample() returns false.
  [[nodiscard]] std::optional<double> density(const Vec3& p_W) const;

  [[nodiscard]] std::size_t storedBytes() const;   // of the grid on the CPU [byte]
  [[nodiscard]] std::size_t storedBricks() const;  // that are not constant

  struct Grid;                                      // holds the OpenVDB grid; engine/field/field_grid.hpp
  [[nodiscard]] const Grid& grid() const noexcept;  // for engine/field and engine/vdb
  explicit Volume(std::unique_ptr<Grid> grid);

 private:
  std::unique_ptr<Grid> grid_;
};

// Throws Error(kBadInput) if a volume is one voxel thick: such a volume can be filtered and has gradients, but it has
// no cell of eight voxels, so no surface to feel. Also if its densities are so large that gradients fit no float.
void checkTouchable(const Volume& volume);

}  // namespace palpate
