// SPDX-License-Identifier: Apache-2.0
// engine/files/invesalius_archive.hpp: what an InVesalius project holds, read with libarchive and libplist, which are
// in the module "invesalius" (base/module.hpp). Private to engine/files. A damaged project may end the process, so only
// a child process may read one.
#pragma once

#include <array>
#include <span>
#include <string>

#include "base/error.hpp"
#include "base/vec.hpp"
#include "engine/field/value_type.hpp"

namespace palpate {

// The content of main.plist, as plain data that a child process can hand over.
struct InvesaliusProject {
  Vec3i size = Vec3i::Zero();
  ValueType type = ValueType::kInt16;
  std::array<double, 3> spacing_mm = {0, 0, 0};
};

struct InvesaliusModule {
  static constexpr const char* kModule = "invesalius";
  static constexpr const char* kTable = "palpate_invesalius";
  // Both throw Error: kBadInput for a damaged project, kOutOfMemory for one beyond the budget.
  InvesaliusProject (*readProject)(const std::string& name, std::size_t memory_budget_bytes);
  // Fills `raw` with the voxels, as they lie in the file, and checks all that follows them.
  void (*readMatrix)(const std::string& name, const InvesaliusProject& project, std::span<char> raw);
};

// Throws Error(kBadInput) for a damaged project.
[[noreturn]] inline void refuseProject(const std::string& source, const std::string& reason) {
  throw Error(Error::Code::kBadInput, source, reason, "save the project again in InVesalius");
}

}  // namespace palpate
