// SPDX-License-Identifier: Apache-2.0
// apps/load/load_and_tell.hpp: loads a volume that the user named and tells what is odd about it. Every verb loads so,
// except those that print the remark themselves (`palpate info`). Set-up code, one thread.
#pragma once

#include <string>

#include "apps/console/progress.hpp"
#include "engine/field/volume.hpp"
#include "engine/files/volume_file.hpp"

namespace palpate {

// loadVolume(). Then ends the line of progress and writes "palpate: SOURCE: REMARK" as one line on stderr, if the
// volume has a remark (VolumeFacts::remark).
[[nodiscard]] Volume loadAndTell(const std::string& name, Progress& progress);
// The line alone, for a volume that loadVolume() has loaded.
void tellRemark(const Volume& volume);

}  // namespace palpate
