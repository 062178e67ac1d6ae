// SPDX-License-Identifier: Apache-2.0
// engine/files/dicom_parts.hpp: the volumes that one DICOM series holds. Private to engine/files. Any thread.
//
// A file of frames may hold several stacks (StackID), one stack at several times (TemporalPositionIndex), or one stack
// several times over for another reason: echoes, b-values and directions of diffusion, magnitude and phase. What the
// reasons are, the file says as dimensions.
// Source: DICOM PS3.3, C.7.6.17 (multi-frame dimensions).
#pragma once

#include <vector>

#include "engine/files/dicom_slice.hpp"

namespace palpate {

// One series for each stack and phase, in the order of both. Where frames of these still lie at one place, one for each
// value of the dimensions in which such frames differ, as few of these as tell them apart. Sets DicomSlice::part.
// Slices of files that name no dimensions, or other ones than the rest, are not divided further.
[[nodiscard]] std::vector<DicomSeries> partsOf(DicomSeries slices);

}  // namespace palpate
