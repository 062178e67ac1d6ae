// SPDX-License-Identifier: Apache-2.0
#include "apps/plan/counted_run.hpp"

#include <fstream>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/console/call_program.hpp"
#include "apps/console/interrupt.hpp"
#include "apps/path/path_csv.hpp"
#include "apps/plan/purposes.hpp"
#include "apps/scene/scene_text.hpp"
#include "base/atomic_file.hpp"
#include "base/error.hpp"
#include "base/stopwatch.hpp"

namespace palpate {
namespace {

constexpr double kLongestPath_s = 2;
constexpr double kCountedRun_s = 0.2;  // a built path fits into it, contact included

std::filesystem::path journalIn(const std::filesystem::path& folder) {
  return folder / "journal";
}

std::filesystem::path saveIn(const std::filesystem::path& folder) {
  return folder / "saved.vdb";
}

gpu::KernelUse kernelOf(const nlohmann::json& kernel) {
  gpu::KernelUse use{.name = kernel.at("name"),
                     .constants = {},
                     .made_s = 1e-3 * kernel.at("made_ms").get<double>(),
                     .dispatches = kernel.at("dispatches")};
  for (const std::string constant : kernel.at("constants")) {
    const std::size_t equals = constant.find('=');
    use.constants.emplace_back(constant.substr(0, equals),
                               static_cast<std::uint32_t>(std::stoul(constant.substr(equals + 1))));
  }
  return use;
}

RunCounts countsOf(const nlohmann::json& summary) {
  const nlohmann::json& work = summary.at("work");
  RunCounts counts;
  counts.vulkan_device = summary.at("vulkan").at("device");
  for (const nlohmann::json& kernel : work.at("kernels")) counts.gpu.kernels.push_back(kernelOf(kernel));
  for (const nlohmann::json& buffer : work.at("buffers"))
    counts.gpu.buffers.push_back({.name = buffer.at("name"), .count = buffer.at("count"), .bytes = buffer.at("bytes")});
  counts.gpu.submissions = work.at("submissions");
  counts.gpu.peak_bytes = work.at("peak_bytes");
  counts.threads = work.at("threads").get<std::vector<std::string>>();
  counts.effect_runs = work.at("effect_runs");
  counts.libraries = summary.at("libraries").get<std::vector<std::string>>();
  counts.plan = summary.at("plan").get<std::vector<std::string>>();
  counts.start_ms = summary.at("servo").at("start_to_first_tick_ms");
  counts.tick_us = summary.at("servo").at("tick_cost_us").at("p50");
  for (const nlohmann::json& stage : summary.at("stages"))
    counts.stages.push_back({stage.at("name"), stage.at("seconds")});
  for (const nlohmann::json& memory : summary.at("memory"))
    if (memory.at("name") == "process peak") counts.main_bytes = memory.at("bytes");
  return counts;
}

// The program's own message, without its name.
std::string reasonIn(const std::string& messages) {
  constexpr std::string_view kName = "palpate: ";
  const std::size_t last = messages.rfind(kName);
  if (last == std::string::npos) return "it said nothing";
  const std::size_t from = last + kName.size();
  return messages.substr(from, messages.find('\n', from) - from);
}

// What a status of the program stands for (exitStatus()). One that it never ends with, or a signal, is a fault of its
// own, and its last message need not be the reason.
[[noreturn]] void failedRun(const Scene& scene, const ProgramEnd& end) {
  for (const Error::Code code : {Error::Code::kBadInput, Error::Code::kNotFound, Error::Code::kIo,
                                 Error::Code::kOutOfMemory, Error::Code::kDevice}) {
    if (end.signal == 0 && end.status == exitStatus(code)) {
      throw Error(code, scene.volume, "the run that should be counted failed: " + reasonIn(end.messages),
                  "run it by itself with 'palpate touch' to see more");
    }
  }
  throw Error(Error::Code::kDevice, scene.volume, "the run that should be counted failed: " + end.failure,
              "this is a fault of Palpate: please report it");
}

}  // namespace

std::size_t RunCounts::ownThreads() const {
  std::set<std::string> names;  // a driver's threads may have the program's name
  for (const std::string& thread : threads)
    if (!threadPurpose(thread).empty()) names.insert(thread);
  return names.size();
}

std::uint64_t RunCounts::dispatches() const noexcept {
  std::uint64_t sum = 0;
  for (const gpu::KernelUse& kernel : gpu.kernels) sum += kernel.dispatches;
  return sum;
}

Scene shortRun(Scene scene, const std::filesystem::path& folder) {
  scene.series.clear();  // the volume's name holds it, as --nan and --resample
  scene.nan.clear();
  scene.resample = false;
  scene.out = (folder / "out").string();
  if (!scene.journal.empty()) scene.journal = journalIn(folder).string();
  if (!scene.save.empty()) scene.save = saveIn(folder).string();
  scene.device = defaultDevice();  // nobody's haptic device moves for a count
  scene.duration_s = kCountedRun_s;
  scene.simulated_clock = false;
  scene.require_real_time = false;
  if (!scene.path_file.empty()) {
    const std::vector<TimedPoint> points = readPathCsv(scene.path_file);
    if (points.back().time_s - points.front().time_s > kLongestPath_s) scene.path_file.clear();
  }
  return scene;
}

RunCounts countedRun(const Scene& scene, const std::filesystem::path& folder, const std::string& program) {
  const Scene run = shortRun(scene, folder);
  const std::filesystem::path file_of_scene = folder / "scene.toml";
  writeFileAtomically(file_of_scene, sceneText(run, folder));
  ProgramCall call{.words = {"touch", file_of_scene.string()}, .shows_messages = false};
  if (!program.empty()) call.program = program;
  for (const std::filesystem::path& old : {journalIn(folder), saveIn(folder), std::filesystem::path(run.out)})
    std::filesystem::remove_all(old);
  const Stopwatch watch;
  const ProgramEnd end = callProgram(call);
  const double wall_ms = 1e3 * watch.seconds();
  throwIfInterrupted("palpate");
  if (!end.failure.empty()) failedRun(scene, end);
  std::ifstream file(std::filesystem::path(run.out) / "summary.json");
  RunCounts counts = countsOf(nlohmann::json::parse(file));
  counts.wall_ms = wall_ms;
  return counts;
}

}  // namespace palpate
