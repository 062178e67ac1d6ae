// SPDX-License-Identifier: Apache-2.0
#include "apps/servo_setup/recording_file.hpp"

#include <filesystem>
#include <fstream>

#include <fmt/format.h>

#include "base/atomic_file.hpp"
#include "base/error.hpp"
#include "base/whole_file.hpp"

namespace palpate {

std::shared_ptr<const Recording> loadRecording(const std::string& file) {
  if (file.empty()) refuse("--device recorded", "no recording is given", "give one with --recording FILE");
  constexpr std::uint64_t kMostBytes = std::uint64_t{4} << 30U;  // 40 hours of a hand that moves at 1 kHz
  return std::make_shared<const Recording>(readRecording(wholeFile(file, "the recording", kMostBytes), file));
}

std::optional<std::string> noteOnRecording(const Scene& scene) {
  if (scene.device != kRecorded) return {};
  const auto recording = loadRecording(scene.recording);
  if (recording->damage.empty()) return {};
  return fmt::format("the recording {} is damaged: {}; the {:.1f} s before that are played", scene.recording,
                     recording->damage, static_cast<double>(recording->gridTicks()) / recording->rate_hz);
}

double recordedDuration_s(const Scene& scene) {
  const auto recording = loadRecording(scene.recording);
  return static_cast<double>(recording->gridTicks()) / recording->rate_hz;
}

void checkRecordable(const std::string& file) {
  checkWritable(file);
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) return;
  const std::uintmax_t bytes = std::filesystem::file_size(file, ignored);
  if (!ignored && bytes == 0) return;  // mktemp(1) makes such files
  std::ifstream stream(file, std::ios::binary);
  std::string begin(kRecordingBegin.size(), '\0');
  stream.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  if (begin != kRecordingBegin)
    refuse(file, "it is there, and is no recording", "move it away, or name another file with --record");
}

void saveRecording(const std::string& file, const Recording& recording) {
  writeFileAtomically(file, recordingBytes(recording));
}

}  // namespace palpate
