// SPDX-License-Identifier: Apache-2.0
// engine/files/formats.hpp: the registry of what loadVolume can read. A new format is one file with a reader
// that readers.hpp declares, one line in formats.cpp, and its first bytes in magic.cpp.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/field/volume.hpp"

namespace palpate {

// The arguments of a reader.
struct ReadRequest {
  std::string name;  // as the user gave it, without what is after '?': "scan.nrrd", "file.vdb#density", "folder#1.2.3"
  std::size_t memory_budget_bytes = 0;  // 0: what the machine has free
  std::optional<float> instead_of_nan;  // VolumeFacts::instead_of_nan
  bool resample = false;                // VolumeName::resample
};

struct VolumeFormat {
  std::string name;                   // "NRRD"
  std::vector<std::string> suffixes;  // lower case, with the dot; empty: not chosen by suffix
  std::string description;            // one line for help texts
  Volume (*read)(const ReadRequest& request);
  bool has_parts = false;  // whether a name may end with a part, "file.vdb#density"; otherwise loadVolume refuses it
  bool resamples = false;  // whether its reader knows ReadRequest::resample; otherwise loadVolume refuses it
};

// Every format, in the order in which help texts list them. Any thread.
[[nodiscard]] const std::vector<VolumeFormat>& volumeFormats();

}  // namespace palpate
