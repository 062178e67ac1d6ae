// SPDX-License-Identifier: Apache-2.0
// apps/sculpt/tick_recording.hpp: the tool's way and its brushes as a file that `palpate touch --path` replays.
//
// A row for each tick: time since the recording began, where the tool was, and the brush that it held. Ticks that the
// servo left out are filled in on the straight line between their neighbours, as a path has no holes. One thread. Cost:
// some 60 bytes a tick.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include "apps/servo_setup/rig_settings.hpp"
#include "servo/loop/tick_record.hpp"

namespace palpate {

// The command that replays the file: the volume touched along it, felt as by these settings.
[[nodiscard]] std::string replayCommand(const std::string& volume, const std::string& file, const RigSettings& felt);

class TickRecording {
 public:
  // Makes the file. Throws Error(kIo) if it exists already or cannot be made. `rate_hz`: the servo's.
  TickRecording(const std::filesystem::path& file, double rate_hz);

  // With the next ticks the tool holds this brush (toolBrushText()); empty: none.
  void hold(const std::string& brush) { brush_ = brush; }
  // The next tick. Throws Error(kIo) where the disk is full; the whole rows that were written before stay.
  void add(const TickRecord& tick);
  // Writes what is left. Throws as add() does.
  void close();

  [[nodiscard]] const std::filesystem::path& file() const noexcept { return file_; }
  [[nodiscard]] std::int64_t rows() const noexcept { return rows_; }
  [[nodiscard]] double seconds() const noexcept { return static_cast<double>(rows_) / rate_hz_; }

 private:
  void write(const Vec3& hip_W);
  void keepWholeRows() const;
  void check();

  std::filesystem::path file_;
  std::ofstream stream_;
  double rate_hz_;
  std::string brush_;
  std::optional<TickRecord> last_;
  std::int64_t rows_ = 0;
};

}  // namespace palpate
