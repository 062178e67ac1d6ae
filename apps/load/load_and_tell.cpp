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

void tellRemark(const Volume& volume) {
  const VolumeFacts& facts = volume.facts();
  if (!facts.remark.empty()) tellUser(facts.source + ": " + facts.remark);
}

}  // namespace palpate
