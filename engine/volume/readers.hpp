// SPDX-License-Identifier: Apache-2.0
// engine/volume/readers.hpp: one reader per format. Private to engine/volume; loadVolume chooses among them.
//
// Each takes the name as the user gave it ("scan.nrrd", "file.vdb#density", "folder#1.2.3") and the memory budget
// [byte], 0 for what the machine has free. Each throws Error and leaves nothing half done.
#pragma once

#include <string>

#include "engine/volume/volume.hpp"

namespace palpate {

[[nodiscard]] Volume readPhantom(const std::string& name, std::size_t memory_budget_bytes);
[[nodiscard]] Volume readVdb(const std::string& name, std::size_t memory_budget_bytes);
[[nodiscard]] Volume readNrrd(const std::string& name, std::size_t memory_budget_bytes);
[[nodiscard]] Volume readNifti(const std::string& name, std::size_t memory_budget_bytes);
[[nodiscard]] Volume readMeta(const std::string& name, std::size_t memory_budget_bytes);
[[nodiscard]] Volume readDicom(const std::string& name, std::size_t memory_budget_bytes);
[[nodiscard]] Volume readInvesalius(const std::string& name, std::size_t memory_budget_bytes);

}  // namespace palpate
