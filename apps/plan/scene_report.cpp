// SPDX-License-Identifier: Apache-2.0
#include "apps/plan/scene_report.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "apps/plan/purposes.hpp"
#include "base/byte_size.hpp"
#include "base/json_text.hpp"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

std::string passesText(const SceneReport& report) {
  std::string text = fmt::format(
      "{} at isovalue {:g} on {}\n\nPasses and fields: those that this scene needs (do), and those that it does not "
      "(leave), with the memory that this saves:\n\n",
      report.volume, report.isovalue, report.gpu);
  for (const PlanLine& line : report.lines) {
    text += fmt::format("  {:<8}  {:<64} {:>10}  {}\n", line.done ? "do" : "leave", line.what,
                        line.saved_bytes > 0 ? "-" + inMiB(line.saved_bytes) : "", line.why);
  }
  std::vector<std::string> times;
  for (const StageTime& pass : report.passes)
    times.push_back(fmt::format("{} {:.1f} ms", pass.name, 1e3 * pass.seconds));
  return text + fmt::format("\nTime at the start: {}.\n", fmt::join(times, ", "));
}

std::string pipelinesText(const gpu::GpuUse& use) {
  std::string text = fmt::format(
      "\nPipelines, as the driver made them for this scene, with the constants that they are specialised for:\n\n"
      "| pipeline | constants | made in [ms] | dispatches | what for |\n|---|---|---:|---:|---|\n");
  for (const gpu::KernelUse& kernel : use.kernels) {
    std::vector<std::string> constants;
    for (const auto& [name, value] : kernel.constants) constants.push_back(fmt::format("{}={}", name, value));
    text += fmt::format("| `{}` | {} | {:.1f} | {} | {} |\n", kernel.name, fmt::join(constants, " "),
                        1e3 * kernel.made_s, kernel.dispatches, kernelPurpose(kernel.name));
  }
  std::set<std::string> names;
  for (const gpu::KernelUse& kernel : use.kernels)
    for (const auto& [name, value] : kernel.constants) names.insert(name);
  if (names.empty()) return text;
  text += "\n| constant | what it says |\n|---|---|\n";
  for (const std::string& name : names) text += fmt::format("| `{}` | {} |\n", name, constantPurpose(name));
  return text;
}

std::string buffersText(const gpu::GpuUse& use) {
  std::string text = fmt::format(
      "\nBuffers on the device at the end; at most {} at one time:\n\n"
      "| buffer | how many | size | what for |\n|---|---:|---:|---|\n",
      bytesInWords(use.peak_bytes));
  for (const gpu::BufferUse& buffer : use.buffers)
    text += fmt::format("| {} | {} | {} | {} |\n", buffer.name, buffer.count, bytesInWords(buffer.bytes),
                        bufferPurpose(buffer.name));
  return text;
}

std::string threadsText(const std::vector<std::string>& threads) {
  std::string text = "\nThreads while the servo runs:\n\n| thread | what for |\n|---|---|\n";
  std::size_t others = 0;
  std::set<std::string> told;  // a driver's threads may have the program's name, and are younger
  for (const std::string& thread : threads) {
    const std::string_view reason = threadPurpose(thread);
    if (reason.empty() || !told.insert(thread).second) {
      ++others;
    } else {
      text += fmt::format("| `{}` | {} |\n", thread, reason);
    }
  }
  if (others > 0) text += fmt::format("| {} more | the Vulkan driver and libraries |\n", others);
  return text;
}

// "friction, texture": one by one.
std::vector<std::string> effectNames(const std::string& names) {
  std::vector<std::string> list;
  for (std::size_t at = 0; at < names.size();) {
    const std::size_t end = std::min(names.find(", ", at), names.size());
    list.push_back(names.substr(at, end - at));
    at = end + 2;
  }
  return list;
}

std::string effectsText(const std::string& names, std::int64_t runs) {
  if (names.empty()) return "\nServo effects: none, as the scene names none.\n";
  std::string text = fmt::format(
      "\nServo effects, in the order in which they act; they ran {} times:\n\n| effect | what for |\n|---|---|\n",
      runs);
  for (const std::string& name : effectNames(names)) text += fmt::format("| {} | {} |\n", name, effectPurpose(name));
  return text;
}

bool isLoaded(const std::vector<std::string>& libraries, const std::string& module) {
  return std::ranges::find(libraries, module + ".so") != libraries.end();
}

// Those that come with no module, or with two.
std::size_t otherLibraries(const std::vector<ModuleCost>& modules, const std::vector<std::string>& libraries) {
  std::size_t others = libraries.size();
  for (const ModuleCost& module : modules)
    if (isLoaded(libraries, module.name)) others -= std::min<std::size_t>(others, module.libraries);
  return others;
}

std::string librariesText(const SceneReport& report, const std::vector<std::string>& libraries) {
  std::string text = fmt::format(
      "\nLibraries that are loaded when a scene uses them, and what each takes by itself; {} shared libraries are "
      "loaded in "
      "all:\n\n"
      "| library | loaded | time [ms] | memory | libraries | what for |\n|---|---|---:|---:|---:|---|\n",
      libraries.size());
  for (const ModuleCost& module : report.modules) {
    const char* loaded = isLoaded(libraries, module.name) ? "yes" : "no";
    if (!module.failure.empty()) {
      text += fmt::format("| {} | {} | | | | {}; it cannot be loaded: {} |\n", module.name, loaded,
                          modulePurpose(module.name), module.failure);
    } else {
      text += fmt::format("| {} | {} | {:.1f} | {} | {} | {} |\n", module.name, loaded, module.ms,
                          bytesInWords(module.bytes), module.libraries, modulePurpose(module.name));
    }
  }
  return text + fmt::format(
                    "| all others | yes | | | {} | the C and C++ libraries, Vulkan with its driver, and what these and "
                    "the modules share |\n",
                    otherLibraries(report.modules, libraries));
}

// "+1.5 MiB", "-3 KiB", "0".
std::string signedBytes(double bytes) {
  if (std::abs(bytes) < 1) return "0";
  return (bytes < 0 ? "-" : "+") + bytesInWords(static_cast<std::uint64_t>(std::abs(bytes)));
}
std::string signedCount(std::int64_t count) {
  return count == 0 ? "0" : fmt::format("{:+}", count);
}

// A dash where the runs of the same scene differ by more.
std::string clearText(const MeasuredDifference& difference, const std::string& text) {
  return difference.isClear() ? text : "-";
}

std::string featuresText(const SceneCounts& counted) {
  const std::vector<FeatureCost>& costs = counted.costs;
  if (costs.empty()) {
    return fmt::format(
        "\nWhat each feature costs was not measured; --rounds 3 runs this scene {} times, nearly all without a "
        "picture. "
        "This run took {:.1f} s.\n",
        3 * (features().size() + 1), 1e-3 * counted.counts.wall_ms);
  }
  std::string text =
      "\nWhat each feature adds, measured by running this scene with and without it (a dash: no more than runs of the "
      "same "
      "scene differ by, or only one run of each). A scene that `has` it would save that without it, one that `lacks` "
      "it "
      "saves that now; a minus is what the feature itself saves.\n\n"
      "| | feature | to the first tick [ms] | a tick [us] | GPU peak | main memory | pipelines | dispatches | threads "
      "| "
      "libraries | why |\n|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---|\n";
  for (const FeatureCost& cost : costs) {
    const Feature& feature = *cost.feature;
    const std::string what = cost.is_in ? feature.name : fmt::format("{} ({})", feature.name, feature.example);
    const char* word = cost.is_in ? "has" : "lacks";
    const char* why = cost.is_in ? feature.why : feature.why_not;
    if (!cost.failure.empty()) {
      text += fmt::format("| {} | {} | | | | | | | | | {}; not measured: {} |\n", word, what, why, cost.failure);
      continue;
    }
    text += fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |\n", word, what,
                        clearText(cost.start_ms, fmt::format("{:+.1f}", cost.start_ms.value)),
                        clearText(cost.tick_us, fmt::format("{:+.2f}", cost.tick_us.value)),
                        signedBytes(static_cast<double>(cost.gpu_bytes)),
                        clearText(cost.main_bytes, signedBytes(cost.main_bytes.value)), signedCount(cost.pipelines),
                        clearText(cost.dispatches, fmt::format("{:+.0f}", cost.dispatches.value)),
                        signedCount(cost.threads), signedCount(cost.libraries), why);
  }
  return text;
}

Json useJson(const gpu::GpuUse& use) {
  Json kernels = Json::array();
  for (const gpu::KernelUse& kernel : use.kernels) {
    Json constants = Json::object();
    for (const auto& [name, value] : kernel.constants) constants[name] = value;
    kernels.push_back({{"name", kernel.name},
                       {"constants", constants},
                       {"made_ms", 1e3 * kernel.made_s},
                       {"dispatches", kernel.dispatches},
                       {"why", kernelPurpose(kernel.name)}});
  }
  Json buffers = Json::array();
  for (const gpu::BufferUse& buffer : use.buffers) {
    buffers.push_back(
        {{"name", buffer.name}, {"count", buffer.count}, {"bytes", buffer.bytes}, {"why", bufferPurpose(buffer.name)}});
  }
  return {
      {"pipelines", kernels}, {"buffers", buffers}, {"submissions", use.submissions}, {"peak_bytes", use.peak_bytes}};
}

Json differenceJson(const MeasuredDifference& difference) {
  return {{"value", difference.value}, {"spread", difference.spread}};
}

Json featureJson(const FeatureCost& cost) {
  Json json = {{"name", cost.feature->name},
               {"is_in", cost.is_in},
               {"why", cost.is_in ? cost.feature->why : cost.feature->why_not}};
  if (!cost.is_in) json["measured_with"] = cost.feature->example;
  if (!cost.failure.empty()) {
    json["not_measured"] = cost.failure;
    return json;
  }
  json["start_ms"] = differenceJson(cost.start_ms);
  json["tick_us"] = differenceJson(cost.tick_us);
  json["main_bytes"] = differenceJson(cost.main_bytes);
  json["gpu_bytes"] = cost.gpu_bytes;
  json["pipelines"] = cost.pipelines;
  json["dispatches"] = differenceJson(cost.dispatches);
  json["effect_runs"] = cost.effect_runs;
  json["threads"] = cost.threads;
  json["libraries"] = cost.libraries;
  return json;
}

}  // namespace

std::string reportDocument(const SceneReport& report) {
  std::string text = passesText(report);
  if (!report.counted) return text + fmt::format("\nNothing was counted: {}.\n", report.not_counted);
  const RunCounts& counts = report.counted->counts;
  return text + pipelinesText(counts.gpu) + buffersText(counts.gpu) + threadsText(counts.threads) +
         effectsText(report.effects, counts.effect_runs) + librariesText(report, counts.libraries) +
         featuresText(*report.counted);
}

std::string reportJson(const SceneReport& report) {
  Json json = {{"schema", "palpate.plan/1"},  {"volume", report.volume}, {"isovalue_density", report.isovalue},
               {"vulkan_device", report.gpu}, {"passes", Json::array()}, {"stages", Json::array()},
               {"effects", report.effects},   {"modules", Json::array()}};
  for (const PlanLine& line : report.lines)
    json["passes"].push_back(
        {{"done", line.done}, {"what", line.what}, {"why", line.why}, {"saved_bytes", line.saved_bytes}});
  for (const StageTime& pass : report.passes)
    json["stages"].push_back({{"name", pass.name}, {"seconds", pass.seconds}});
  const bool is_counted = report.counted.has_value();
  for (const ModuleCost& module : report.modules) {
    json["modules"].push_back({{"name", module.name},
                               {"loaded", is_counted && isLoaded(report.counted->counts.libraries, module.name)},
                               {"ms", module.ms},
                               {"bytes", module.bytes},
                               {"libraries", module.libraries},
                               {"failure", module.failure},
                               {"why", modulePurpose(module.name)}});
  }
  json["counted"] = is_counted ? useJson(report.counted->counts.gpu) : Json(nullptr);
  json["not_counted"] = is_counted ? Json(nullptr) : Json(report.not_counted);
  json["features"] = Json::array();
  if (!is_counted) return jsonFileText(json);
  json["counted"]["threads"] = report.counted->counts.threads;
  json["counted"]["libraries"] = report.counted->counts.libraries;
  json["counted"]["effect_runs"] = report.counted->counts.effect_runs;
  for (const FeatureCost& cost : report.counted->costs) json["features"].push_back(featureJson(cost));
  return jsonFileText(json);
}

}  // namespace palpate
