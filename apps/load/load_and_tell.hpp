// SPDX-License-Identifier: Apache-2.0
// apps/load/load_and_tell.hpp: loads a volume that the user named and tells what is odd about it. Every verb loads or
// tells so, except `palpate info`, whose result has it. Set-up code, one thread.
#pragma once

#include <string>

#include "apps/console/progress.hpp"
#include "engine/field/volume.hpp"
#include "engine/files/volume_file.hpp"

namespace palpate {

// loadVolume(). Then ends the line of progress and writes "palpate: SOURCE: REMARK" as one line on stderr, if the
// volume has a remark (VolumeFacts::remark), and another if its numbers were rounded so that it may be felt.
[[nodiscard]] Volume loadAndTell(const std::string& name, Progress& progress);
// The lines alone, for a volume that loadVolume() has loaded. `rounding`: whether numbers that no float holds are told
// of always, or only if what they lose is not small beside the range of densities.
enum class TellRounding { kAlways, kIfFelt };
void tellRemark(const Volume& volume, TellRounding rounding = TellRounding::kIfFelt);

}  // namespace palpate
