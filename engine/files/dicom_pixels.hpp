// SPDX-License-Identifier: Apache-2.0
// engine/files/dicom_pixels.hpp: reads the pixels of a DICOM series. Private to engine/files. Set-up thread.
//
// Pixels that are plain bytes or packed as RLE are read here. GDCM unpacks others in a child process (gdcm_child.hpp).
// In all cases the words are as they are stored, and dicom_values.hpp says what they mean.
#pragma once

#include <string>
#include <vector>

#include "engine/files/dicom_values.hpp"

namespace palpate {

// The densities of all slices, in the order of the series. Throws Error(kBadInput) for pixels that are not as the
// transfer syntax says, for packed pixels that GDCM cannot unpack or that have bits beyond those that
// HighBit and BitsStored name, and for a file that changed since it was checked; Error(kIo) for one that cannot be
// read. Memory: 4 bytes a pixel, and for packed slices their words. Cost: reads the pixels once.
[[nodiscard]] std::vector<float> readDicomPixels(const DicomSeries& series, const std::vector<DicomValueRule>& rules,
                                                 const std::string& source);

}  // namespace palpate
