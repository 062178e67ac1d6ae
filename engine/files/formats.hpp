// SPDX-License-Identifier: Apache-2.0
// engine/files/formats.hpp: the registry of what loadVolume can read. A new format is one file with a reader and one
// line in formats.cpp.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/field/volume.hpp"

namespace palpate {

// What a reader is asked for.
struct ReadRequest {
  std::string name;  // as the user gave it, without "?nan=": "scan.nrrd", "file.vdb#density", "folder#1.2.3"
  std::size_t memory_budget_bytes = 0;  // 0: what the machine has free
  std::optional<float> instead_of_nan;  // VolumeFacts::instead_of_nan
};

struct VolumeFormat {
  std::string name;                   // "NRRD"
  std::vector<std::string> suffixes;  // lower case, with the dot; empty for what is chosen in another way
  std::string description;            // one line for help texts
  Volume (*read)(const ReadRequest& request);
  bool has_parts = false;  // so that a name may end with one: "file.vdb#density"; else loadVolume refuses it
};

// Every format, in the order in which help texts list them. Any thread.
[[nodiscard]] const std::vector<VolumeFormat>& volumeFormats();

}  // namespace palpate
