// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/recording_file.hpp"

#include <fstream>
#include <iterator>

#include "base/atomic_file.hpp"
#include "base/error.hpp"

namespace palpate {

std::shared_ptr<const Recording> loadRecording(const std::string& file) {
  if (file.empty()) refuse("--device recorded", "no recording is given", "give one with --recording FILE");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw Error(Error::Code::kNotFound, file, "the recording cannot be opened", "check its name and rights");
  const std::string bytes(std::istreambuf_iterator<char>(stream), {});
  return std::make_shared<const Recording>(readRecording(bytes, file));
}

double recordedDuration_s(const Scene& scene) {
  const auto recording = loadRecording(scene.recording);
  return static_cast<double>(recording->gridTicks()) / recording->rate_hz;
}

void saveRecording(const std::string& file, const Recording& recording) {
  writeFileAtomically(file, recordingBytes(recording));
}

}  // namespace palpate
