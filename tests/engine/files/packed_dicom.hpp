// SPDX-License-Identifier: Apache-2.0
// A DICOM slice as archives keep it: its pixels packed, by GDCM.
#pragma once

#include <string>

namespace palpate {

enum class DicomPacking { kRle, kJpegLossless, kJpegLs, kJpeg2000 };

// `slice`: the bytes of a file whose pixels are not packed. Throws std::runtime_error where GDCM cannot.
[[nodiscard]] std::string packedDicom(const std::string& slice, DicomPacking packing);

// Where the bytes of the slice's one packed frame lie: first and end.
struct Fragment {
  std::size_t first = 0, end = 0;
};
[[nodiscard]] Fragment fragmentOf(const std::string& packed);

// The slice with other bytes in place of the frame's, and their length.
[[nodiscard]] std::string withFragment(const std::string& packed, std::string bytes);

}  // namespace palpate
