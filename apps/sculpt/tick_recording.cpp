// SPDX-License-Identifier: Apache-2.0
#include "apps/sculpt/tick_recording.hpp"

#include <iterator>
#include <string>

#include <fmt/format.h>

#include "apps/scene/scene_command.hpp"
#include "apps/servo_setup/scene_settings.hpp"
#include "base/error.hpp"

namespace palpate {

std::string replayCommand(const std::string& volume, const std::string& file, const RigSettings& felt) {
  Scene scene = withRigSettings({}, felt);
  scene.volume = volume;
  scene.path_file = file;
  scene.rate_hz = felt.parameters.rate_hz;
  return sceneCommand("touch", scene);
}

TickRecording::TickRecording(const std::filesystem::path& file, double rate_hz) : file_(file), rate_hz_(rate_hz) {
  std::error_code unknown;
  if (std::filesystem::exists(file_, unknown)) {
    throw Error(Error::Code::kIo, file_.string(), "the file exists already", "give another name, or move it away");
  }
  stream_.open(file_);
  stream_ << "time_s,x_m,y_m,z_m,brush\n";
  check();
}

void TickRecording::add(const TickRecord& tick) {
  const Vec3 hip_W = asVec3(tick.hip_W);
  if (last_) {
    const Vec3 before_W = asVec3(last_->hip_W);
    const std::int64_t gap = tick.tick - last_->tick;
    for (std::int64_t i = 1; i < gap; ++i) {
      write(before_W + (hip_W - before_W) * (static_cast<double>(i) / static_cast<double>(gap)));
    }
  }
  write(hip_W);
  last_ = tick;
  check();
}

void TickRecording::close() {
  if (!stream_.is_open()) return;
  stream_.flush();
  check();
  stream_.close();
}

void TickRecording::write(const Vec3& hip_W) {
  // In as many digits as are read back to the same bits.
  stream_ << fmt::format("{},{},{},{},{}\n", static_cast<double>(rows_) / rate_hz_, hip_W.x(), hip_W.y(), hip_W.z(),
                         brush_);
  ++rows_;
}

// A row that was cut short would be read as another place, or not at all.
void TickRecording::keepWholeRows() const {
  std::ifstream written(file_, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(written)), std::istreambuf_iterator<char>());
  std::error_code ignored;
  std::filesystem::resize_file(file_, text.rfind('\n') + 1, ignored);
}

void TickRecording::check() {
  if (stream_) return;
  stream_.close();
  keepWholeRows();
  throw Error(Error::Code::kIo, file_.string(), "the recording cannot be written",
              "check that the folder exists, may be written to and has room");
}

}  // namespace palpate
