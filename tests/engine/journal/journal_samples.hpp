// SPDX-License-Identifier: Apache-2.0
// tests/engine/journal/journal_samples.hpp: a small volume, the header of its journal and random edits, for tests of
// journals.
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include "engine/edit/random_edits.hpp"
#include "engine/journal/journal_writer.hpp"
#include "file_size_limit.hpp"
#include "temporary_folder.hpp"

namespace palpate {

inline constexpr double kLow = -100;
inline constexpr double kHigh = 200;

inline Lattice sampleLattice() {
  Lattice lattice;
  lattice.origin_W = {0.01, -0.02, 0.03};
  lattice.spacing_m = {0.7e-3, 0.9e-3, 1.3e-3};
  lattice.R_WL = Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized()).matrix();
  return lattice;
}

// A ball with a ramp, isovalue 30. With the default size no side is a multiple of 8.
inline Volume sampleVolume(double radius_voxels = 8, const Vec3i& size = {27, 22, 19}) {
  std::vector<float> values;
  for (int k = 0; k < size.z(); ++k) {
    for (int j = 0; j < size.y(); ++j) {
      for (int i = 0; i < size.x(); ++i) {
        const double inside = radius_voxels - (Vec3(i, j, k) - Vec3(13, 10.5, 9)).norm();
        values.push_back(static_cast<float>(std::clamp(30 + 40 * inside, kLow, kHigh)));
      }
    }
  }
  return Volume::fromDense(size, sampleLattice(), values, {});
}

inline JournalHeader sampleHeader(const Volume& volume) {
  return {identityOf(volume), brushProfile(30, kLow, kHigh, volume.lattice().spacing_m)};
}

inline std::string bytesOf(const std::filesystem::path& folder) {
  return contentsOf(journalFile(folder));
}
// Makes a new file each time: some file systems flush a file to the disk at once if it is truncated and written again.
inline void setBytes(const std::filesystem::path& folder, const std::string& bytes) {
  std::filesystem::remove(journalFile(folder));
  std::ofstream(journalFile(folder), std::ios::binary | std::ios::trunc) << bytes;
}

inline EditCommand dab(double x_m) {
  EditCommand command;
  command.from_W = command.to_W = {x_m, 0, 0};
  command.radius_m = 2e-3;
  return command;
}

}  // namespace palpate
