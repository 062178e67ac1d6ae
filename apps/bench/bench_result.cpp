// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/bench_result.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "apps/report/machine_facts.hpp"
#include "base/quantile.hpp"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

Json jsonOf(const BenchFigure& figure) {
  return std::visit([](const auto& value) { return Json(value); }, figure);  // a number that is not finite: null
}

std::string csvCell(const BenchFigure& figure) {
  if (const auto* text = std::get_if<std::string>(&figure)) {
    if (text->find_first_of(",\"\n") == std::string::npos) return *text;
    std::string quoted = "\"";
    for (const char c : *text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + "\"";
  }
  if (const auto* count = std::get_if<std::int64_t>(&figure)) return std::to_string(*count);
  const double value = std::get<double>(figure);
  return std::isfinite(value) ? fmt::format("{}", value) : std::string();
}

double numberOf(const BenchFigure& figure) {
  if (const auto* count = std::get_if<std::int64_t>(&figure)) return static_cast<double>(*count);
  return std::get<double>(figure);
}

bool isEqual(const BenchFigure& a, const BenchFigure& b) {
  const bool text = std::holds_alternative<std::string>(a);
  if (text != std::holds_alternative<std::string>(b)) return false;
  return text ? a == b : numberOf(a) == numberOf(b);
}

}  // namespace

BenchResult beginBench(const std::string& bench, const std::string& vulkan_device) {
  BenchResult result;
  result.bench = bench;
  result.machine = machineInWords();
  result.vulkan_device = vulkan_device;
  return result;
}

const BenchFigure* findFigure(const BenchRow& row, std::string_view key) {
  const auto at = std::find_if(row.begin(), row.end(), [&](const auto& cell) { return cell.first == key; });
  return at == row.end() ? nullptr : &at->second;
}

bool BenchResult::allHold() const noexcept {
  return std::all_of(targets.begin(), targets.end(), [](const BenchTarget& target) { return target.holds(); });
}

double figureOf(const BenchRow& row, std::string_view key) {
  const BenchFigure* figure = findFigure(row, key);
  if (figure == nullptr) throw std::out_of_range(fmt::format("a row has no '{}'", key));
  return numberOf(*figure);
}

std::string textOf(const BenchRow& row, std::string_view key) {
  const BenchFigure* figure = findFigure(row, key);
  const auto* text = figure == nullptr ? nullptr : std::get_if<std::string>(figure);
  return text == nullptr ? std::string() : *text;
}

std::optional<double> numberIn(const BenchRow& row, std::string_view key) {
  const BenchFigure* figure = findFigure(row, key);
  if (figure == nullptr || std::holds_alternative<std::string>(*figure)) return std::nullopt;
  const double number = numberOf(*figure);
  return std::isnan(number) ? std::nullopt : std::optional(number);
}

bool hasAll(const BenchRow& row, const BenchRow& like) {
  return std::all_of(like.begin(), like.end(), [&](const auto& cell) {
    const BenchFigure* figure = findFigure(row, cell.first);
    return figure != nullptr && isEqual(*figure, cell.second);
  });
}

BenchRows rowsOf(const BenchResult& result, std::string_view part, const BenchRow& like) {
  BenchRows rows;
  for (const BenchRow& row : result.rows) {
    if (textOf(row, "part") == part && hasAll(row, like)) rows.push_back(&row);
  }
  return rows;
}

bool promise(BenchResult& result, const Promise& what) {
  std::vector<double> values;
  for (const BenchRow* row : rowsOf(result, what.part, what.like)) {
    if (what.up_to_m_per_s > 0 && figureOf(*row, "speed_m_per_s") > what.up_to_m_per_s) continue;
    for (const char* key : what.keys) {
      const BenchFigure* figure = findFigure(*row, key);
      if (figure == nullptr) continue;
      values.push_back(std::holds_alternative<std::string>(*figure) ? std::nan("") : numberOf(*figure));
    }
  }
  if (!values.empty()) result.targets.push_back({what.name, what.of(values), what.bound});
  return !values.empty();
}

double largestOf(const std::vector<double>& values) {
  const auto none = std::find_if(values.begin(), values.end(), [](double value) { return std::isnan(value); });
  return none != values.end() ? *none : *std::max_element(values.begin(), values.end());
}

double sumOf(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

double firstOf(const std::vector<double>& values) {
  return values.front();
}

double medianOf(const std::vector<double>& values) {
  return median(values);
}

std::string machineInWords() {
  const MachineFacts machine = readMachineFacts();
  return fmt::format("{}, {} cores, {:.1f} GiB, {}, {}", machine.cpu, machine.cores,
                     static_cast<double>(machine.memory_bytes) / 1073741824.0, machine.kernel, machine.os);
}

std::string jsonText(const BenchResult& result) {
  std::vector<std::string> rows, targets;
  for (const BenchRow& row : result.rows) {
    Json object = Json::object();
    for (const auto& [key, figure] : row) object[key] = jsonOf(figure);
    rows.push_back(object.dump());
  }
  for (const BenchTarget& target : result.targets) {
    const Json object = {
        {"name", target.name}, {"value", target.value}, {"bound", target.bound}, {"holds", target.holds()}};
    targets.push_back(object.dump());
  }
  // A line for each row: a result of thousands of rows stays short, and two of them can be compared by lines.
  return fmt::format(
      "{{\n\"bench\": {},\n\"commit\": {},\n\"machine\": {},\n\"vulkan_device\": {},\n\"command\": {},\n"
      "\"rows\": [\n{}\n],\n\"targets\": [\n{}\n]\n}}\n",
      Json(result.bench).dump(), Json(result.commit).dump(), Json(result.machine).dump(),
      Json(result.vulkan_device).dump(), Json(result.command).dump(), fmt::join(rows, ",\n"),
      fmt::join(targets, ",\n"));
}

std::string csvText(const BenchResult& result) {
  // Columns in the order of the rows. Those of notes come last, so that a note moves no other column.
  std::vector<std::string> keys;
  for (const bool notes : {false, true}) {
    for (const BenchRow& row : result.rows) {
      if ((textOf(row, "part") == "note") != notes) continue;
      for (const auto& cell : row) {
        if (std::find(keys.begin(), keys.end(), cell.first) == keys.end()) keys.push_back(cell.first);
      }
    }
  }
  std::string text;
  for (const std::string& key : keys) text += (text.empty() ? "" : ",") + key;
  text += "\n";
  for (const BenchRow& row : result.rows) {
    for (std::size_t i = 0; i < keys.size(); ++i) {
      const BenchFigure* figure = findFigure(row, keys[i]);
      if (i > 0) text += ",";
      if (figure != nullptr) text += csvCell(*figure);
    }
    text += "\n";
  }
  return text;
}

std::string targetTable(const BenchResult& result) {
  std::size_t width = 0;
  for (const BenchTarget& target : result.targets) width = std::max(width, target.name.size());
  std::string text;
  for (const BenchRow* row : rowsOf(result, "note")) text += "note: " + textOf(*row, "note") + "\n";
  std::size_t held = 0;
  for (const BenchTarget& target : result.targets) {
    held += target.holds() ? 1 : 0;
    text += fmt::format("{:<{}}  {:>10.4g}  <= {:<8g}  {}\n", target.name, width, target.value, target.bound,
                        target.holds() ? "holds" : "DOES NOT HOLD");
  }
  return text + fmt::format("{} of {} targets hold\n", held, result.targets.size());
}

std::string asParagraph(std::string_view literal) {
  if (literal.starts_with('\n')) literal.remove_prefix(1);
  std::string line(literal);
  std::replace(line.begin(), line.end(), '\n', ' ');
  return line;
}

std::string benchPage(const BenchResult& result, const PageWords& words) {
  std::string page = fmt::format("# {}\n\n{}\n\n", words.title, words.introduction);
  page += fmt::format("- machine: {}\n- Vulkan device: {}\n- commit: {}\n- command: `{}`\n\n", result.machine,
                      result.vulkan_device, result.commit, result.command);
  if (!words.chart.empty()) page += fmt::format("![{}]({})\n\n", words.title, words.chart);
  page += "## What is promised\n\n| target | value | at most | |\n|---|---|---|---|\n";
  for (const BenchTarget& target : result.targets) {
    page += fmt::format("| {} | {:.4g} | {:.4g} | {} |\n", target.name, target.value, target.bound,
                        target.holds() ? "holds" : "**does not hold**");
  }
  page += "\n";
  for (const BenchRow* row : rowsOf(result, "note")) page += fmt::format("Note: {}\n\n", textOf(*row, "note"));
  return page + "## Figures\n\n```\n" + words.tables + "```\n";
}

}  // namespace palpate
