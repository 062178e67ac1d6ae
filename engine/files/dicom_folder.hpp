// SPDX-License-Identifier: Apache-2.0
// engine/files/dicom_folder.hpp: the series of a folder of DICOM slices. Private to engine/files. Set-up thread.
#pragma once

#include <map>
#include <string>

#include "engine/files/dicom_slice.hpp"

namespace palpate {

using DicomFolder = std::map<std::string, DicomSeries>;  // by UID

// Every series of the folder, with its slices in the order of their file names. A file that is not a DICOM slice is
// skipped, unless its name ends in ".dcm". Throws Error(kIo) for a file that cannot be opened, Error(kBadInput) for a
// damaged one and for a folder without slices. Cost: reads every file, and its header once more in a child process.
[[nodiscard]] DicomFolder readDicomFolder(const std::string& folder, const std::string& source);

// Returns the UID of the chosen series. `wanted`: its number in the order of UIDs, or its UID; empty: the only series.
// Throws Error(kBadInput) with a list of all series if there is no such series, or if `wanted` is empty and there are
// several.
[[nodiscard]] std::string chooseSeries(const DicomFolder& all, const std::string& wanted, const std::string& source);

}  // namespace palpate
