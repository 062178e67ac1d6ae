// SPDX-License-Identifier: Apache-2.0
// engine/files/dicom_upright.hpp: slices of a tilted gantry as a block whose axes are orthogonal. Private to
// engine/files. Any thread.
//
// The upright block has the slices' axes, pixel size and heights, so it is as high as they are. It is as wide as all of
// them together. Heights are the same, so the trilinear interpolation of the tilted block is bilinear in each slice. It
// reproduces fields that are linear along columns and rows.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/files/dicom_geometry.hpp"

namespace palpate {

struct UprightBlock {
  Lattice lattice;
  std::int64_t columns = 0, rows = 0;            // [voxel]
  std::int64_t first_column = 0, first_row = 0;  // where it begins, counted in the lowest slice's pixels
};

// The smallest one of whole pixels that holds every pixel of the slices, to a thousandth of a pixel.
[[nodiscard]] UprightBlock uprightBlockOf(const DicomSeries& series, const Lattice& lowest);

// `values`: of the slices, one after another. Voxels outside a slice become noValue(), as do those that lie beside a
// pixel without a value; beside a pixel that is too large for a float they become beyondFloat(). Memory and cost: one
// float for each voxel.
[[nodiscard]] std::vector<float> resampledUpright(const std::vector<float>& values, const DicomSeries& series,
                                                  const UprightBlock& block);

}  // namespace palpate
