// SPDX-License-Identifier: Apache-2.0
// engine/files/dicom_structure.hpp: whether a DICOM file is complete, and its elements. Private to engine/files.
//
// A cut file lacks pixels, and a damaged length may ask for any memory. So the elements of each file are checked first.
// Source: DICOM PS3.5, chapter 7 (data set structure) and annex A (transfer syntaxes).
#pragma once

#include <optional>
#include <string_view>

#include "engine/files/dicom_data_set.hpp"

namespace palpate {

// The elements of a complete file; empty for another one. It is complete if every element, item and fragment of `file`
// (all its bytes) ends inside it, tags ascend, types exist, and no pixel is missing. Pixels are counted only if they
// are uncompressed or packed as RLE; for other codings the library that unpacks them must find out. Cost: one step for
// each element and each run of RLE. No copy but for a deflated file, which is unpacked first (512 MiB at most), and of
// the elements that Palpate reads. Any thread.
[[nodiscard]] std::optional<DicomDataSet> readDicomDataSet(std::string_view file);
[[nodiscard]] inline bool dicomIsWhole(std::string_view file) {
  return readDicomDataSet(file).has_value();
}

// What is behind the head of a deflated file, unpacked; empty if it is damaged. The offsets of its data set count here.
[[nodiscard]] std::optional<std::string> inflatedDicom(std::string_view file);

// Whether GDCM unpacks this transfer syntax: JPEG, JPEG-LS or JPEG 2000. Others, such as videos, nobody does.
[[nodiscard]] bool gdcmUnpacks(std::string_view syntax);

// Whether what is unpacked may differ from what was packed (PS3.5, 8.2): beyond the stored bits, too.
[[nodiscard]] bool dicomIsLossy(std::string_view syntax);

// Whether pixels are plain bytes in this transfer syntax; in every other one they are packed.
[[nodiscard]] bool dicomIsPlain(std::string_view syntax);

// True if the file's class (PS3.6, annex A) says that it holds no image: a DICOMDIR, a report, a plan, a document.
// Archives put such files beside the slices.
[[nodiscard]] bool dicomIsNoImage(std::string_view file);

}  // namespace palpate
