// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/columns.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace palpate {
namespace {

std::string padded(const std::string& text, int width) {
  return width < 0 ? fmt::format("{:<{}}", text, -width) : fmt::format("{:>{}}", text, width);
}

std::string cell(const BenchFigure& figure, const Look& look) {
  if (const auto* text = std::get_if<std::string>(&figure)) return padded(*text, look.width);
  const auto* count = std::get_if<std::int64_t>(&figure);
  const double value = count != nullptr ? static_cast<double>(*count) : std::get<double>(figure);
  if (!std::isfinite(value)) return padded("-", look.width);
  return padded(look.digits < 0 ? fmt::format("{:g}", value) : fmt::format("{:.{}f}", value, look.digits), look.width);
}

std::string cell(const BenchRow& row, const Column<BenchRow>& column) {
  if (column.figure) return cell(column.figure(row), column.look);
  const BenchFigure* figure = findFigure(row, column.key);
  return figure == nullptr ? padded("", column.look.width) : cell(*figure, column.look);
}

// A line of a cell for each column, without blanks at its end.
template <class CellOf>
std::string lineOf(const TableColumns& columns, const CellOf& cell_of) {
  std::string line;
  for (const Column<BenchRow>& column : columns) line += (line.empty() ? "" : " ") + cell_of(column);
  line.erase(line.find_last_not_of(' ') + 1);
  return line + "\n";
}

std::string headOf(const TableColumns& columns, std::string Look::*words) {
  return lineOf(columns, [&](const auto& column) { return padded(column.look.*words, column.look.width); });
}

}  // namespace

std::string tableText(const BenchResult& result, const Table& table) {
  std::string text, last;
  for (const BenchRow& row : result.rows) {
    if (std::find(table.parts.begin(), table.parts.end(), textOf(row, "part")) == table.parts.end()) continue;
    const std::string title = table.title ? table.title(row) : "";
    if (text.empty() || title != last) {
      if (!title.empty()) text += (text.empty() ? "" : "\n") + title + "\n";
      text += headOf(table.columns, &Look::heading);
      const std::string units = headOf(table.columns, &Look::unit);
      if (units != "\n") text += units;
    }
    last = title;
    text += lineOf(table.columns, [&](const auto& column) { return cell(row, column); });
  }
  return text;
}

std::string cellText(const BenchRow& row, const std::string& key, int width, int digits) {
  return cell(row, {key, nullptr, {.width = width, .digits = digits}});
}

void LineByLine::add(const std::string& name, const std::string& cell) {
  auto line = std::find_if(lines_.begin(), lines_.end(), [&](const auto& one) { return one.first == name; });
  if (line == lines_.end()) line = lines_.insert(line, {name, ""});
  line->second += cell;
}

std::string LineByLine::text() const {
  std::string text;
  for (const auto& [name, cells] : lines_) text += name + cells + "\n";
  return text;
}

}  // namespace palpate
