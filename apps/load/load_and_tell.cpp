// SPDX-License-Identifier: Apache-2.0
#include "apps/load/load_and_tell.hpp"

#include "apps/console/message.hpp"
#include "engine/files/volume_file.hpp"

namespace palpate {

Volume loadAndTell(const std::string& name, Progress& progress) {
  Volume volume = loadVolume(name);
  progress.done();
  tellRemark(volume);
  return volume;
}

void tellRemark(const Volume& volume, TellRounding rounding) {
  const VolumeFacts& facts = volume.facts();
  if (!facts.remark.empty()) tellUser(facts.source + ": " + facts.remark);
  constexpr double kFelt = 1e-4;  // of the range of densities: six steps of a scan of 16 bits
  const double range = static_cast<double>(volume.maximum()) - volume.minimum();
  const bool is_felt = facts.rounded.most > kFelt * range;
  if (facts.rounded.count > 0 && (is_felt || rounding == TellRounding::kAlways))
    tellUser(facts.source + ": " + facts.rounded.words());
}

}  // namespace palpate
