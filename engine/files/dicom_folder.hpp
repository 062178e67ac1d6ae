// SPDX-License-Identifier: Apache-2.0
// engine/files/dicom_folder.hpp: the series of a folder of DICOM slices. Private to engine/files. Set-up thread.
#pragma once

#include <map>
#include <string>

#include "engine/files/dicom_slice.hpp"

namespace palpate {

// By UID. A series that holds several volumes (dicom_parts.hpp) counts as one series for each: "UID/0001", "UID/0002".
using DicomFolder = std::map<std::string, DicomSeries>;

// Every series of the folder, with its slices in the order of their file names and frames. A file that is not a DICOM
// slice is skipped, unless its name ends in ".dcm". Throws Error(kIo) for a file that cannot be opened,
// Error(kBadInput) for a damaged one and for a folder without slices. Cost: reads every file.
[[nodiscard]] DicomFolder readDicomFolder(const std::string& folder, const std::string& source);

// The series for messages: UID, which of its volumes where the UID is not enough, and the words that the scanner gave
// it.
[[nodiscard]] std::string wordsOfSeries(const DicomFolder& all, const std::string& key, bool description_first);

// Returns the UID of the chosen series. `wanted`: its number in the order of UIDs, or its UID; empty: the only series.
// Throws Error(kBadInput) with a list of all series if there is no such series, or if `wanted` is empty and there are
// several; with a list of the volumes of one series if it is the UID of several.
[[nodiscard]] std::string chooseSeries(const DicomFolder& all, const std::string& wanted, const std::string& source);

}  // namespace palpate
