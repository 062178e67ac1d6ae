// SPDX-License-Identifier: Apache-2.0
// Writes int16 volumes with ITK. Like engine/files/itk_file.hpp it must not meet Eigen.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace palpate {

enum class ItkWriter { kNrrd, kNifti, kMeta };

struct ItkImage {
  std::vector<unsigned> size;                   // [voxel]
  std::array<double, 3> origin_mm = {0, 0, 0};  // LPS
  std::array<double, 3> spacing_mm = {1, 1, 1};
  std::array<std::array<double, 3>, 3> direction = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  // of i, j, k
  std::vector<std::int16_t> values;                                                      // i fastest
  unsigned components = 1;
};

void writeWithItk(ItkWriter writer, const std::string& path, const ItkImage& image, bool compressed);

}  // namespace palpate
