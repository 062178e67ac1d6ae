// SPDX-License-Identifier: Apache-2.0
// A small NRRD file, byte by byte, so that each of its parts can be made wrong.
#pragma once

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

namespace palpate {

struct NrrdBytes {
  std::string sizes = "16 16 16";
  std::string spacings = "1 1 1";  // [mm]
  std::vector<float> values;       // i fastest

  [[nodiscard]] std::string bytes() const {
    std::string data(values.size() * sizeof(float), '\0');
    std::memcpy(data.data(), values.data(), data.size());
    return "NRRD0004\ntype: float\ndimension: 3\nsizes: " + sizes + "\nspacings: " + spacings +
           "\nendian: little\nencoding: raw\n\n" + data;
  }
};

// A ball of 5 mm radius in 16^3 voxels of 1 mm: density = 100 (5 - distance from the centre), so 0 is its surface.
inline NrrdBytes ballNrrd() {
  NrrdBytes nrrd;
  for (int k = 0; k < 16; ++k) {
    for (int j = 0; j < 16; ++j) {
      for (int i = 0; i < 16; ++i) {
        nrrd.values.push_back(static_cast<float>(100 * (5 - std::hypot(i - 7.5, j - 7.5, k - 7.5))));
      }
    }
  }
  return nrrd;
}

}  // namespace palpate
