// SPDX-License-Identifier: Apache-2.0
// engine/files/dicom_structure.hpp: whether a DICOM file's elements are all there. Private to engine/files.
//
// GDCM makes up the pixels that a cut file lacks, and sets aside whatever memory a damaged length asks for. So each
// file's elements are walked first. Source: DICOM PS3.5, chapter 7 (data set structure) and annex A (transfer
// syntaxes).
#pragma once

#include <string_view>

namespace palpate {

// True if every element, item and fragment of `file` (all its bytes) ends inside it, tags ascend, types exist, and
// pixels that are not packed, or packed as RLE, are all there. Of other packed pixels the library that unpacks them has
// to say it. Cost: one step an element, and one a run of RLE; no copy, but of a deflated file, whose elements are
// unpacked, 512 MiB at most. Any thread.
[[nodiscard]] bool dicomIsWhole(std::string_view file);

// True for a file that by its class (PS3.6, annex A) holds no image: a DICOMDIR, a report, a plan, a document. Archives
// put them beside the slices.
[[nodiscard]] bool dicomIsNoImage(std::string_view file);

}  // namespace palpate
