// SPDX-License-Identifier: Apache-2.0
// engine/files/dicom_structure.hpp: whether a DICOM file is complete. Private to engine/files.
//
// GDCM invents the pixels that a cut file lacks, and allocates whatever memory a damaged length asks for. So the
// elements of each file are checked first. Source: DICOM PS3.5, chapter 7 (data set structure) and annex A (transfer
// syntaxes).
#pragma once

#include <string_view>

namespace palpate {

// True if every element, item and fragment of `file` (all its bytes) ends inside it, tags ascend, types exist, and no
// pixel is missing. Pixels are counted only if they are uncompressed or packed as RLE; for other codings the library
// that unpacks them must find out. Cost: one step for each element and each run of RLE. No copy, except for a deflated
// file, which is unpacked first (512 MiB at most). Any thread.
[[nodiscard]] bool dicomIsWhole(std::string_view file);

// True if the file's class (PS3.6, annex A) says that it holds no image: a DICOMDIR, a report, a plan, a document.
// Archives put such files beside the slices.
[[nodiscard]] bool dicomIsNoImage(std::string_view file);

}  // namespace palpate
