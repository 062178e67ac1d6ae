// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/served_status.hpp"

#include <algorithm>
#include <fstream>
#include <string_view>

#include <fmt/format.h>
#include <unistd.h>

#include "base/units.hpp"
#include "servo/safety/faults.hpp"

namespace palpate {
namespace {

constexpr std::string_view kFault = "fault_";

// What a process has in memory [byte]; 0: it is gone, or not ours to see.
double residentBytes(std::int64_t process) {
  std::ifstream file(fmt::format("/proc/{}/statm", process));
  double pages = 0, resident = 0;
  return file >> pages >> resident ? resident * static_cast<double>(sysconf(_SC_PAGESIZE)) : 0;
}

double number(std::uint64_t count) {
  return static_cast<double>(count);
}

using S = const ServedStatus&;

// clang-format off
constexpr StatusFigure kFigures[] = {
    {"servo", "1 while a servo is there", false, [](S s, std::int64_t) { return s.servo ? 1.0 : 0.0; }},
    {"servos", "servos that have come so far", true, [](S s, std::int64_t) { return number(s.servos); }},
    {"clients", "clients that are connected", false, [](S s, std::int64_t) { return number(s.clients); }},
    {"tick", "newest tick of the servo", true, [](S s, std::int64_t) { return static_cast<double>(s.pose.tick); }},
    {"pose_age_ms", "since the servo's newest pose was seen [ms]", false, [](S s, std::int64_t now_ns) {
       return s.pose.tick < 0 ? 0.0 : static_cast<double>(now_ns - s.pose_at_ns) / kNanosecondsPerMillisecond;
     }},
    {"window_age_ms", "age of the window that the servo's newest tick used [ms]", false, [](S s, std::int64_t) {
       return s.servo ? static_cast<double>(s.window_age_ns) / kNanosecondsPerMillisecond : 0.0;
     }},
    {"force_N", "force that the device was sent last [N]", false, [](S s, std::int64_t) { return s.pose.force_W.norm(); }},
    {"force_off", "1 while the device exerts no force, whatever it is sent", false, [](S s, std::int64_t) { return s.servo && s.force_off != ForceOff::kNone ? 1.0 : 0.0; }},
    {"contact", "1 while the tool is in contact", false, [](S s, std::int64_t) { return s.pose.normal_W.isZero(0) ? 0.0 : 1.0; }},
    {"faults", "fault bits of the newest pose (palpate faults)", false, [](S s, std::int64_t) { return static_cast<double>(s.pose.faults); }},
    {"windows", "windows that the servo has read", true, [](S s, std::int64_t) { return number(s.windows); }},
    {"edits", "edits made, undo and redo included", true, [](S s, std::int64_t) { return number(s.edits); }},
    {"refused", "edits that were refused", true, [](S s, std::int64_t) { return number(s.refused); }},
    {"waiting_for_disk", "edits that are made but not on the disk", false, [](S s, std::int64_t) { return number(s.waiting_for_disk); }},
    {"waiting", "edits, undos, redos and saves that the engine has not begun", false, [](S s, std::int64_t) { return number(s.waiting); }},
    {"undoable", "edits that can be undone", false, [](S s, std::int64_t) { return number(s.undoable); }},
    {"redoable", "edits that can be redone", false, [](S s, std::int64_t) { return number(s.redoable); }},
    {"unsaved", "1 while no saved file holds every edit", false, [](S s, std::int64_t) { return s.unsaved ? 1.0 : 0.0; }},
    {"journal_bytes", "length of the journal [byte]", false, [](S s, std::int64_t) { return number(s.journal_bytes); }},
    {"journal_failed", "1 while edits are not kept, since the journal cannot be written", false, [](S s, std::int64_t) { return s.journal_failure.empty() ? 0.0 : 1.0; }},
    {"lost_records", "records of the journal before this start that could not be read, and nothing else had", false, [](S s, std::int64_t) { return number(s.lost_records); }},
    {"engines", "engines made so far: one more for each lost device and each change of filters", true, [](S s, std::int64_t) { return number(s.engines); }},
    {"gpu_bytes", "buffers on the Vulkan device [byte]", false, [](S s, std::int64_t) { return number(s.gpu_bytes); }},
    {"engine_memory_bytes", "resident memory of the engine's process [byte]", false, [](S, std::int64_t) { return residentBytes(getpid()); }},
    {"servo_memory_bytes", "resident memory of the servo's process [byte]", false, [](S s, std::int64_t) {
       return s.servo && s.servo_process > 0 ? residentBytes(s.servo_process) : 0.0;
     }},
};
// clang-format on

// A name as Prometheus allows it.
std::string metricName(std::string_view key) {
  std::string name = fmt::format("palpate_{}", key);
  std::ranges::replace(name, '-', '_');
  return name;
}

}  // namespace

void notePose(ServedStatus& status, const ToolPose& pose, std::uint64_t first_window, std::int64_t now_ns) {
  const std::uint32_t begun = pose.faults & ~status.pose.faults;
  for (std::size_t i = 0; i < status.faults_begun.size(); ++i) status.faults_begun[i] += begun >> i & 1U;
  if (pose.tick != status.pose.tick) status.pose_at_ns = now_ns;
  status.pose = pose;
  status.windows = pose.window_version >= first_window ? pose.window_version - first_window + 1 : 0;
}

std::span<const StatusFigure> statusFigures() noexcept {
  return kFigures;
}

std::vector<std::pair<std::string, double>> figuresOf(const ServedStatus& status, std::int64_t now_ns) {
  std::vector<std::pair<std::string, double>> figures;
  for (const StatusFigure& one : kFigures) figures.emplace_back(one.key, one.value(status, now_ns));
  for (std::size_t i = 0; i < faultTable().size() && i < status.faults_begun.size(); ++i) {
    if (status.faults_begun[i] > 0)
      figures.emplace_back(fmt::format("{}{}", kFault, faultTable()[i].name), number(status.faults_begun[i]));
  }
  return figures;
}

std::string metricsText(const std::vector<std::pair<std::string, double>>& figures) {
  std::string text, faults;
  for (const auto& [key, value] : figures) {
    if (key.starts_with(kFault)) {
      faults += fmt::format("palpate_faults_begun{{fault=\"{}\"}} {}\n", key.substr(kFault.size()), value);
      continue;
    }
    const auto* const known = std::ranges::find(kFigures, std::string_view(key), &StatusFigure::key);
    if (known == std::end(kFigures)) continue;
    const std::string name = metricName(key);
    text += fmt::format("# HELP {0} {1}\n# TYPE {0} {2}\n{0} {3}\n", name, known->help,
                        known->is_counter ? "counter" : "gauge", value);
  }
  if (!faults.empty())
    text +=
        "# HELP palpate_faults_begun times that a fault of the servo was seen to begin\n"
        "# TYPE palpate_faults_begun counter\n" +
        faults;
  return text;
}

}  // namespace palpate
