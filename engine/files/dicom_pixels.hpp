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

struct DicomPixels {
  std::vector<float> densities;  // of all slices, in the order of the series
  std::vector<bool> padding;     // which of them are padding; empty: no file names any
  std::size_t clamped = 0;       // pixels that a lossy coding put beyond the stored bits
  RoundedFew rounded;            // padding among them
};

// Throws Error(kBadInput) for pixels that are not as the transfer syntax says, or in one that nobody unpacks; for
// packed pixels that GDCM cannot unpack, or that have bits beyond those that HighBit and BitsStored name although their
// coding loses nothing; and for a file that changed since it was checked. Throws Error(kIo) for one that cannot be
// read. Memory: 4 bytes a pixel, one bit a pixel where files name padding, and for packed slices their words. Cost:
// reads the pixels once.
[[nodiscard]] DicomPixels readDicomPixels(const DicomSeries& series, const std::vector<DicomValueRule>& rules,
                                          const std::string& source);

}  // namespace palpate
