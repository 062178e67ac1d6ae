// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/bench_result.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/report/machine_facts.hpp"

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

const BenchFigure* find(const BenchRow& row, std::string_view key) {
  const auto at = std::find_if(row.begin(), row.end(), [&](const auto& cell) { return cell.first == key; });
  return at == row.end() ? nullptr : &at->second;
}

}  // namespace

bool BenchResult::allHold() const noexcept {
  return std::all_of(targets.begin(), targets.end(), [](const BenchTarget& target) { return target.holds(); });
}

double figureOf(const BenchRow& row, std::string_view key) {
  const BenchFigure* figure = find(row, key);
  if (figure == nullptr) throw std::out_of_range(fmt::format("a row has no '{}'", key));
  if (const auto* count = std::get_if<std::int64_t>(figure)) return static_cast<double>(*count);
  return std::get<double>(*figure);
}

std::string textOf(const BenchRow& row, std::string_view key) {
  const BenchFigure* figure = find(row, key);
  const auto* text = figure == nullptr ? nullptr : std::get_if<std::string>(figure);
  return text == nullptr ? std::string() : *text;
}

std::string machineInWords() {
  const MachineFacts machine = readMachineFacts();
  return fmt::format("{}, {} cores, {:.1f} GiB, {}, {}", machine.cpu, machine.cores,
                     static_cast<double>(machine.memory_bytes) / 1073741824.0, machine.kernel, machine.os);
}

std::string jsonText(const BenchResult& result) {
  Json rows = Json::array();
  for (const BenchRow& row : result.rows) {
    Json object = Json::object();
    for (const auto& [key, figure] : row) object[key] = jsonOf(figure);
    rows.push_back(std::move(object));
  }
  Json targets = Json::array();
  for (const BenchTarget& target : result.targets) {
    targets.push_back(
        {{"name", target.name}, {"value", target.value}, {"bound", target.bound}, {"holds", target.holds()}});
  }
  const Json json = {{"bench", result.bench},        {"commit", result.commit},
                     {"machine", result.machine},    {"vulkan_device", result.vulkan_device},
                     {"command", result.command},    {"rows", std::move(rows)},
                     {"targets", std::move(targets)}};
  return json.dump(1) + "\n";
}

std::string csvText(const BenchResult& result) {
  // Columns as rows bring them, notes last: whether there is one, and when, moves none of the others.
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
      const BenchFigure* figure = find(row, keys[i]);
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
  for (const BenchRow& row : result.rows) {
    if (textOf(row, "part") == "note") text += "note: " + textOf(row, "note") + "\n";
  }
  std::size_t held = 0;
  for (const BenchTarget& target : result.targets) {
    held += target.holds() ? 1 : 0;
    text += fmt::format("{:<{}}  {:>10.4g}  <= {:<8g}  {}\n", target.name, width, target.value, target.bound,
                        target.holds() ? "holds" : "DOES NOT HOLD");
  }
  return text + fmt::format("{} of {} targets hold\n", held, result.targets.size());
}

}  // namespace palpate
