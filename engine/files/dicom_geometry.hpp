// SPDX-License-Identifier: Apache-2.0
// engine/files/dicom_geometry.hpp: where the slices of a DICOM series lie. Private to engine/files. Set-up thread.
//
// Source: DICOM PS3.3, C.7.6.2 (Image Plane). Positions and directions are LPS millimetres. Order and spacing of slices
// come from their positions, never from file names or slice thickness.
#pragma once

#include <string>

#include "base/lattice.hpp"
#include "engine/files/dicom_slice.hpp"

namespace palpate {

struct DicomBlock {
  Lattice lattice;  // its third axis is the slices' normal; of a tilted block that of the first slice, its lowest
  double tilt = 0;  // between the direction in which the slices follow each other and their normal [rad]; 0: upright
};

// Places every slice (placeSlice), sorts them along their normal, and sets DicomSlice::aside_px. Slices that are
// shifted sideways by the same step each, as under a tilted gantry, make a tilted block if `tilted_too`. Throws
// Error(kBadInput) if slices differ in size, spacing or orientation, are fewer than two, lie at the same place, are
// missing or unevenly spaced, or are shifted sideways in another way.
[[nodiscard]] DicomBlock placeSlices(DicomSeries& series, const std::string& source, bool tilted_too);

}  // namespace palpate
