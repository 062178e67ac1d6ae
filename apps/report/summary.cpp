// SPDX-License-Identifier: Apache-2.0
#include "apps/report/summary.hpp"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "apps/report/path_outcome.hpp"
#include "apps/report/words.hpp"
#include "apps/scene/object_table.hpp"
#include "apps/scene/option_table.hpp"
#include "base/atomic_file.hpp"
#include "base/json_text.hpp"
#include "servo/loop/run_figures.hpp"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

// Makes JSON from the value's text as the command line takes it; empty if no value is set.
struct ToJson {
  std::string text;

  Json operator()(const NumberOption&) const { return orNull(numberOf(text)); }
  Json operator()(const IntegerOption&) const { return std::stoll(text); }
  Json operator()(const BytesOption&) const { return text.empty() ? Json(nullptr) : Json(text); }
  Json operator()(const VectorOption&) const {
    const std::optional<Vec3> vector = vectorOf(text);
    return vector ? Json{vector->x(), vector->y(), vector->z()} : Json(nullptr);
  }
  // "a:b,c:d" is [[a,b],[c,d]].
  Json operator()(const TableOption&) const {
    if (text.empty()) return nullptr;
    std::string rows;
    for (const char c : text) rows += c == ',' ? "],[" : std::string(1, c == ':' ? ',' : c);
    return Json::parse("[[" + rows + "]]");
  }
  template <class Words>
  Json operator()(const Words&) const {
    return text;
  }

 private:
  static Json orNull(const std::optional<double>& number) { return number ? Json(*number) : Json(nullptr); }
};

Json toJson(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}
Json toJson(const Percentiles& p) {
  return {{"count", p.count}, {"p50", p.p50}, {"p90", p.p90}, {"p99", p.p99}, {"p99_9", p.p999}, {"max", p.max}};
}

template <typename Item, typename Convert>
Json listOf(const std::vector<Item>& items, Convert convert) {
  Json list = Json::array();
  for (const Item& item : items) list.push_back(convert(item));
  return list;
}

Json volumeJson(const RunVolume& v) {
  return {{"name", v.name},
          {"format", v.format},
          {"size_voxel", {v.size.x(), v.size.y(), v.size.z()}},
          {"spacing_m", toJson(v.spacing_m)},
          {"minimum_density", v.minimum},
          {"maximum_density", v.maximum},
          {"isovalue_density", v.isovalue}};
}

Json machineJson(const MachineFacts& m) {
  return {{"cpu", m.cpu}, {"cores", m.cores}, {"memory_bytes", m.memory_bytes}, {"kernel", m.kernel}, {"os", m.os}};
}

Json contactJson(const RunFigures& f) {
  return {{"ticks", f.contact_ticks},     {"time_s", f.contact_s},
          {"touches", f.touches},         {"first_s", f.first_contact_s >= 0 ? Json(f.first_contact_s) : Json(nullptr)},
          {"way_m", f.surface_way_m},     {"force_N", toJson(f.force_N)},
          {"depth_m", toJson(f.depth_m)}, {"force_step_max_N", f.force_step_max_N}};
}

Json pathJson(const TouchRun& run) {
  const PathOutcome outcome = pathOutcome(run.records, run.phases, run.scene.rate_hz);
  return {{"slide_lost_s", outcome.lost_s},
          {"retreat_touches", outcome.retreat_touches},
          {"retreat_ends_in_contact", outcome.ends_in_contact}};
}

// By the simulated clock a tick takes no time and none is late.
Json servoJson(const TouchRun& run, const RunFigures& f) {
  const auto ifMeasured = [&](const auto& figures) {
    return run.scene.simulated_clock ? Json(nullptr) : Json(toJson(figures));
  };
  return {{"ticks", f.ticks},
          {"time_s", f.time_s},
          {"times_measured", !run.scene.simulated_clock},
          {"start_to_first_tick_ms", 1e3 * run.start_to_first_tick_s},
          {"late_ticks", f.late_ticks},
          {"skipped_ticks", f.skipped_ticks},
          {"faulty_ticks", f.faulty_ticks},
          {"windows_used", f.windows_used},
          {"plane_age_max_ticks", f.plane_age_max_ticks},
          {"loop_us_a_tick", run.loop_us_a_tick ? Json(*run.loop_us_a_tick) : Json(nullptr)},
          {"tick_cost_us", ifMeasured(f.tick_cost_us)},
          {"lateness_us", ifMeasured(f.lateness_us)},
          {"window_age_ms", toJson(f.window_age_ms)},
          {"realtime", run.realtime}};
}

Json energyJson(const RunFigures& f) {
  return {{"min_J", f.energy_min_J},
          {"end_J", f.energy_end_J},
          {"active_ticks", f.active_ticks},
          {"damped_ticks", f.damped_ticks}};
}

Json stabilityJson(const ContactStability& s) {
  const bool unstable = s.verdict == ContactVerdict::kUnstable;
  return {{"verdict", name(s.verdict)},
          {"source", name(s.source)},
          {"given_J", s.given_J},
          {"stored_J", s.stored_J},
          {"share", s.share},
          {"error_J", s.error_J},
          {"allowed_J", s.allowed_J},
          {"bounces", s.bounces},
          {"unstable_from_s", unstable ? Json(s.unstable_from_s) : Json(nullptr)},
          {"unstable_to_s", unstable ? Json(s.unstable_to_s) : Json(nullptr)},
          {"swing_m", unstable ? Json(s.swing_m) : Json(nullptr)},
          {"swing_hz", unstable ? Json(s.swing_hz) : Json(nullptr)},
          {"ended_by_servo", s.ended_by_servo}};
}

Json exactJson(const std::optional<ExactErrors>& e) {
  if (!e) return nullptr;
  const auto orNull = [](const std::optional<double>& v) { return v ? Json(*v) : Json(nullptr); };
  return {{"ticks", e->ticks},
          {"slide_only", e->slide_only},
          {"vhip_median_voxel", orNull(e->vhip_median_voxel)},
          {"vhip_p99_voxel", orNull(e->vhip_p99_voxel)},
          {"force_angle_median_deg", e->force_angle_median_deg},
          {"force_angle_p99_deg", e->force_angle_p99_deg},
          {"force_error_median_N", orNull(e->force_error_median_N)},
          {"force_error_p99_N", orNull(e->force_error_p99_N)}};
}

Json editsJson(const std::optional<RunEdits>& e) {
  if (!e) return nullptr;
  return {{"count", e->count},
          {"published", e->published},
          {"edit_to_window_ms", toJson(percentiles(e->edit_to_window_ms))},
          {"journal_records", e->journal_records},
          {"journal_saved", e->journal_saved},
          {"journal_bytes", e->journal_bytes},
          {"journal_failure", e->journal_failure},
          {"refused", e->refused},
          {"saves", e->saves},
          {"save_failures", e->save_failures},
          {"save_bytes", e->save_bytes},
          {"save_version", e->save_version ? Json(*e->save_version) : Json(nullptr)},
          {"save_s", toJson(percentiles(e->save_s))},
          {"save_failure", e->save_failure},
          {"content", e->content ? Json(fmt::format("{:016x}", *e->content)) : Json(nullptr)},
          {"added_m3", e->added_m3 ? Json(*e->added_m3) : Json(nullptr)}};
}

Json deviceJson(const std::optional<RunDevice>& device) {
  if (!device) return nullptr;
  Json figures = Json::object();
  for (const auto& [key, value] : device->figures) figures[key] = value;
  return {{"kind", device->kind}, {"force_off", device->force_off}, {"figures", figures}};
}

Json faultJson(const RunFault& f) {
  return {{"name", f.name}, {"ticks", f.ticks},   {"first_tick", f.first_tick},
          {"text", f.text}, {"effect", f.effect}, {"remedy", f.remedy}};
}

Json workJson(const RunWork& work, const RunFigures& figures) {
  const auto kernel = [](const gpu::KernelUse& k) {
    const auto constant = [](const auto& c) { return fmt::format("{}={}", c.first, c.second); };
    return Json{{"name", k.name},
                {"constants", listOf(k.constants, constant)},
                {"made_ms", 1e3 * k.made_s},
                {"dispatches", k.dispatches}};
  };
  const auto buffer = [](const gpu::BufferUse& b) {
    return Json{{"name", b.name}, {"count", b.count}, {"bytes", b.bytes}};
  };
  return {{"kernels", listOf(work.gpu.kernels, kernel)},
          {"buffers", listOf(work.gpu.buffers, buffer)},
          {"submissions", work.gpu.submissions},
          {"peak_bytes", work.gpu.peak_bytes},
          {"threads", work.threads},
          {"effect_runs", figures.effect_runs}};
}

// Every option of the table, nested as a scene file nests them: {"servo": {"n": 5, ...}, ...}. Null for a number, size,
// direction, point or table that was not given. "objects": each as --object takes it.
Json sceneJson(const Scene& scene) {
  Json json;
  for (const SceneOption& option : sceneOptions()) {
    std::string place = std::string("/") + option.key;
    std::replace(place.begin(), place.end(), '.', '/');
    json[Json::json_pointer(place)] = std::visit(ToJson{optionText(option.value, scene)}, option.value);
  }
  json["objects"] = Json::array();
  for (const ObjectSpec& object : scene.objects) json["objects"].push_back(objectText(object));
  return json;
}

}  // namespace

Json makeSummary(const TouchRun& run) {
  const RunFigures figures = figuresOf(run);
  const auto stage = [](const StageTime& s) { return Json{{"name", s.name}, {"seconds", s.seconds}}; };
  const auto memory = [](const MemoryFigure& m) { return Json{{"name", m.name}, {"bytes", m.bytes}}; };
  const auto phase = [](const PathPhase& p) {
    return Json{{"name", p.name}, {"begin_s", p.begin_s}, {"end_s", p.end_s}};
  };
  return {{"schema", kSummarySchema},
          {"verdict", verdict(run, figures)},
          {"ended_early", run.ended_early.empty() ? Json(nullptr) : Json(run.ended_early)},
          {"commit", run.commit},
          {"command", run.command},
          {"volume", volumeJson(run.volume)},
          {"contact", contactJson(figures)},
          {"path", pathJson(run)},
          {"servo", servoJson(run, figures)},
          {"energy", energyJson(figures)},
          {"stability", stabilityJson(run.stability)},
          {"exact", exactJson(run.exact)},
          {"edits", editsJson(run.edits)},
          {"device", deviceJson(run.device)},
          {"faults", listOf(run.faults, faultJson)},
          {"notes", run.notes},
          {"phases", listOf(run.phases, phase)},
          {"stages", listOf(run.stages, stage)},
          {"memory", listOf(run.memory, memory)},
          {"plan", run.plan},
          {"libraries", run.libraries},
          {"work", workJson(run.work, figures)},
          {"machine", machineJson(run.machine)},
          {"vulkan",
           {{"device", run.vulkan.device}, {"driver", run.vulkan.driver}, {"api_version", run.vulkan.api_version}}},
          {"scene", sceneJson(run.scene)},
          {"files", run.files}};
}

void writeSummary(const std::filesystem::path& file, const TouchRun& run) {
  // Names of files and drivers need not be valid UTF-8; JSON must be.
  writeFileAtomically(file, jsonFileText(makeSummary(run)));
}

}  // namespace palpate
