// SPDX-License-Identifier: Apache-2.0
#include "apps/report/html_tables.hpp"

#include <fmt/format.h>

#include "apps/report/html_text.hpp"
#include "apps/report/plot_data.hpp"
#include "apps/report/svg_plot.hpp"
#include "apps/report/words.hpp"
#include "apps/scene/object_table.hpp"
#include "apps/scene/option_table.hpp"
#include "base/byte_size.hpp"
#include "base/units.hpp"

namespace palpate {
namespace {

std::string section(const char* id, const char* title, const std::string& body) {
  return fmt::format("<section id=\"{}\">\n<h2>{}</h2>\n{}</section>\n", id, title, body);
}

std::string row(const std::string& name, const std::string& value) {
  return fmt::format("<tr><th scope=\"row\">{}</th><td>{}</td></tr>\n", escapeHtml(name), escapeHtml(value));
}

std::string list(const std::vector<std::string>& lines) {
  if (lines.empty()) return "";
  std::string out = "<ul>\n";
  for (const std::string& line : lines) out += "<li>" + escapeHtml(line) + "</li>\n";
  return out + "</ul>\n";
}

std::string figure(const std::string& value, const std::string& unit, const std::string& meaning) {
  return fmt::format("<div class=\"figure\"><b>{}<small> {}</small></b><span>{}</span></div>\n", escapeHtml(value),
                     escapeHtml(unit), escapeHtml(meaning));
}

std::string mm(double metres) {
  return shortNumber(metres * kMillimetresPerMetre);
}

std::string servoFigures(const TouchRun& run, const RunFigures& f) {
  if (run.scene.simulated_clock) return figure("simulated", "clock", "no times were measured");
  return figure(shortNumber(f.tick_cost_us.p50), "us",
                fmt::format("tick cost, median; 99 % within {} us", shortNumber(f.tick_cost_us.p99))) +
         figure(shortNumber(f.lateness_us.p99), "us",
                fmt::format("wake-up after the due time, 99 %; worst {} us", shortNumber(f.lateness_us.max))) +
         figure(std::to_string(f.late_ticks), "late", fmt::format("of {} ticks{}", f.ticks, leftOutWords(f)));
}

std::string exactFigures(const std::optional<ExactErrors>& e) {
  if (!e) return "";
  const std::string surface = e->vhip_median_voxel
                                  ? figure(shortNumber(*e->vhip_median_voxel), "voxel",
                                           fmt::format("tool point off the exact surface, median; 99 % within {} voxel",
                                                       shortNumber(*e->vhip_p99_voxel)))
                                  : "";
  const std::string force =
      e->force_error_median_N
          ? figure(shortNumber(*e->force_error_median_N), "N",
                   fmt::format("force off the exact one, median; 99 % within {} N", shortNumber(*e->force_error_p99_N)))
          : "";
  return surface + force +
         figure(shortNumber(e->force_angle_median_deg), "degrees",
                fmt::format("force off the exact normal, median; 99 % within {} degrees",
                            shortNumber(e->force_angle_p99_deg)));
}

std::string editFigures(const std::optional<RunEdits>& e) {
  if (!e) return "";
  const std::string change = e->count == 0 ? "" : volumeChange(*e);
  std::string out =
      figure(std::to_string(e->count), e->count == 1 ? "edit" : "edits",
             fmt::format("of which {} reached the window{}", e->published, change.empty() ? "" : "; " + change));
  if (e->published > 0) {
    const Percentiles p = percentiles(e->edit_to_window_ms);
    out += figure(shortNumber(p.p50), "ms",
                  fmt::format("from an edit to its window, median; 99 % within {} ms", shortNumber(p.p99)));
  }
  if (e->refused > 0)
    out += figure(std::to_string(e->refused), "refused", "edits that were not applied; the notes tell why");
  return out;
}

std::string jsonValue(const nlohmann::ordered_json& value) {
  if (value.is_null()) return "chosen by the program";
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (value.is_string()) return value.get<std::string>().empty() ? "-" : value.get<std::string>();
  if (value.is_number_float()) return fmt::format("{:g}", value.get<double>());
  if (!value.is_array()) return value.dump();
  std::string out;
  for (const auto& item : value) out += (out.empty() ? "" : ", ") + jsonValue(item);
  return out;
}

}  // namespace

std::string keyFigures(const TouchRun& run, const RunFigures& f) {
  std::string out = "<div class=\"figures\">\n";
  out += figure(shortNumber(f.contact_s), "s", fmt::format("in contact, of {} s", shortNumber(f.time_s)));
  out += figure(shortNumber(f.force_N.max), "N", fmt::format("largest force; median {} N", shortNumber(f.force_N.p50)));
  out += figure(mm(f.depth_m.max), "mm", fmt::format("deepest press; median {} mm", mm(f.depth_m.p50)));
  out += figure(mm(f.surface_way_m), "mm", "of surface followed");
  if (f.contact_ticks > 0) out += figure(shortNumber(f.energy_end_J * 1e3), "mJ", stabilityWords(run.stability, f));
  out += editFigures(run.edits) + exactFigures(run.exact) + servoFigures(run, f);
  return section("figures", "Key figures", out + "</div>\n");
}

std::string faultSection(const TouchRun& run) {
  std::string body;
  if (run.faults.empty()) body = "<p>No fault was raised.</p>\n";
  for (const RunFault& fault : run.faults) {
    body += fmt::format(
        "<div class=\"fault\"><b>{}</b> in {} of {} ticks, first at tick {}.<br>{}; "
        "the force {}.<br><i>What to do:</i> {}</div>\n",
        escapeHtml(fault.name), fault.ticks, run.records.size(), fault.first_tick, escapeHtml(fault.text),
        escapeHtml(fault.effect), escapeHtml(fault.remedy));
  }
  if (!run.notes.empty()) body += "<p>Worth knowing of this run:</p>\n" + list(run.notes);
  return section("faults", "Faults and notes", body);
}

std::string editSection(const TouchRun& run) {
  if (!run.edits) return "";
  constexpr int kClassesPerDecade = 10;
  const RunEdits& e = *run.edits;
  std::string rows = row("brush", run.scene.edit);
  if (run.scene.journal.empty()) {
    rows += row("journal", "none (--journal keeps every edit on disk)");
  } else {
    const bool is_there = e.journal_bytes > 0;  // a journal without a record has been deleted
    if (is_there) rows += row("journal", run.scene.journal);
    if (is_there || e.journal_records > 0) {
      rows += row("records acknowledged",
                  fmt::format("{} of {}, {}", e.journal_saved, e.journal_records, bytesInWords(e.journal_bytes)));
    }
    if (!e.journal_failure.empty()) rows += row("why not all are", e.journal_failure);
  }
  rows += row("volume", run.scene.save.empty() ? "not saved (--save keeps it)" : saveWords(run));
  if (e.content) rows += row("content", fmt::format("{:016x}", *e.content));
  if (!e.save_failure.empty()) rows += row("why the last save failed", e.save_failure);
  std::string drawn;
  if (const LogHistogram h = logHistogram(e.edit_to_window_ms, kClassesPerDecade); !h.counts.empty()) {
    drawn = "<div>" + histogramSvg(h, "edits by time from edit to window [ms]", "ms", "edits") + "</div>\n";
  }
  return section("edits", "Edits",
                 "<div class=\"figures\">\n" + editFigures(run.edits) + "</div>\n<div class=\"columns\"><table>\n" +
                     rows + "</table>\n" + drawn + "</div>\n");
}

std::string workSection(const TouchRun& run) {
  double total_s = 0;
  std::string stages, memory;
  for (const StageTime& stage : run.stages) {
    total_s += stage.seconds;
    stages += row(stage.name, shortNumber(stage.seconds) + " s");
  }
  for (const MemoryFigure& figure : run.memory) memory += row(figure.name, bytesInWords(figure.bytes));
  return section("work", "Time and memory",
                 "<div class=\"columns\"><table><caption>Stages</caption>\n" + stages +
                     row("all together", shortNumber(total_s) + " s") + "</table>\n<table><caption>Memory</caption>\n" +
                     memory + "</table></div>\n");
}

std::string planSection(const TouchRun& run) {
  return section("plan", "What was computed and what was left out",
                 run.plan.empty() ? "<p>No plan was recorded.</p>\n" : list(run.plan));
}

std::string machineSection(const TouchRun& run) {
  const MachineFacts& m = run.machine;
  return section("machine", "Machine",
                 "<table>\n" + row("processor", m.cpu) + row("cores allowed", std::to_string(m.cores)) +
                     row("memory", bytesInWords(m.memory_bytes)) + row("system", m.os + ", " + m.kernel) +
                     row("Vulkan device", run.vulkan.device) +
                     row("Vulkan driver", run.vulkan.driver + ", Vulkan " + run.vulkan.api_version) + "</table>\n" +
                     (run.realtime.empty() ? "" : "<p>Real time:</p>\n" + list(run.realtime)));
}

// Every option with its flag, and its value as the command line takes it.
std::string parameterSection(const TouchRun& run, const nlohmann::ordered_json& summary) {
  std::string volume, scene;
  for (const auto& [key, value] : summary.at("volume").items()) volume += row(keyInWords(key), jsonValue(value));
  for (const SceneOption& option : sceneOptions()) {
    const std::string value = optionText(option.value, run.scene);
    const bool has_unit = !value.empty() && *option.unit != '\0';
    scene += row(option.flag, has_unit ? value + " " + option.unit : value);
  }
  for (const ObjectSpec& object : run.scene.objects) scene += row("--object", objectText(object));
  return section("parameters", "Volume and parameters",
                 "<table><caption>Volume</caption>\n" + volume +
                     "</table>\n<details><summary>All parameters of the run</summary>\n<table>\n" + scene +
                     "</table></details>\n");
}

std::string repeatSection(const TouchRun& run) {
  std::string body =
      "<pre><code>" + escapeHtml(run.command) + "</code></pre>\n<p>Program version " + escapeHtml(run.commit);
  body += run.scene.simulated_clock ? ". With the simulated clock the trace comes out the same, bit for bit.</p>\n"
                                    : ". With the real clock times differ from run to run.</p>\n";
  return section("repeat", "How to repeat it", body);
}

}  // namespace palpate
