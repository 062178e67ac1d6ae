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

// Checks every slice (checkDicomSlice) and sorts the slices along their normal. Returns the lattice of their volume;
// its third axis is the normal. Throws Error(kBadInput) if slices differ in size, spacing or orientation, are fewer
// than two, lie at the same place, are missing or unevenly spaced, or are shifted sideways, as under a tilted gantry.
[[nodiscard]] Lattice placeSlices(DicomSeries& series, const std::string& source);

}  // namespace palpate
