// SPDX-License-Identifier: Apache-2.0
// engine/files/dicom_folder.hpp: the series of a folder of DICOM slices. Private to engine/files. Set-up thread.
#pragma once

#include <map>
#include <string>

#include "engine/files/dicom_slice.hpp"

namespace palpate {

using DicomFolder = std::map<std::string, DicomSeries>;  // by UID

// Every series of the folder, its slices in the order of their files' names. Files that are no DICOM slices are passed
// over, unless their names say they are. Throws Error: kIo for a file that cannot be opened; kBadInput for one that is
// damaged, and where there is none. Cost: reads every file, and its header once more in a child process.
[[nodiscard]] DicomFolder readDicomFolder(const std::string& folder, const std::string& source);

// Returns the series' UID. `wanted`: its number in the order of UIDs, or its UID; empty: the only one. Throws
// Error(kBadInput) with a list of all where there is no such series, or several and none is wanted.
[[nodiscard]] std::string chooseSeries(const DicomFolder& all, const std::string& wanted, const std::string& source);

}  // namespace palpate
