// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/columns.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>

#include <fmt/format.h>

namespace palpate {
namespace {

std::string padded(const std::string& text, std::size_t width, bool left) {
  return left ? fmt::format("{:<{}}", text, width) : fmt::format("{:>{}}", text, width);
}

std::string wordsOf(const BenchFigure& figure, int digits) {
  if (const auto* text = std::get_if<std::string>(&figure)) return *text;
  const auto* count = std::get_if<std::int64_t>(&figure);
  const double value = count != nullptr ? static_cast<double>(*count) : std::get<double>(figure);
  if (!std::isfinite(value)) return "-";
  return digits < 0 ? fmt::format("{:g}", value) : fmt::format("{:.{}f}", value, digits);
}

std::optional<BenchFigure> figureIn(const BenchRow& row, const Column<BenchRow>& column) {
  if (column.figure) return column.figure(row);
  const BenchFigure* figure = findFigure(row, column.key);
  return figure == nullptr ? std::nullopt : std::optional(*figure);
}

using Line = std::vector<std::string>;  // a cell for each column

// The lines of a table, and how wide each column is.
class Lines {
 public:
  explicit Lines(const TableColumns& columns) : columns_(columns), width_(columns.size()), left_(columns.size()) {
    add(head(&Look::heading));
    add(head(&Look::unit));
  }

  [[nodiscard]] std::string headText() const {
    const std::string units = text(head(&Look::unit));
    return text(head(&Look::heading)) + (units == "\n" ? "" : units);
  }
  Line of(const BenchRow& row) {
    Line line;
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      const std::optional<BenchFigure> figure = figureIn(row, columns_[i]);
      line.push_back(figure ? wordsOf(*figure, columns_[i].look.digits) : "");
      if (figure && std::holds_alternative<std::string>(*figure)) left_[i] = true;
    }
    add(line);
    return line;
  }
  // Without blanks at its end.
  [[nodiscard]] std::string text(const Line& line) const {
    std::string text;
    for (std::size_t i = 0; i < line.size(); ++i) text += (i == 0 ? "" : " ") + padded(line[i], width_[i], left_[i]);
    text.erase(text.find_last_not_of(' ') + 1);
    return text + "\n";
  }

 private:
  [[nodiscard]] Line head(std::string Look::*words) const {
    Line line;
    for (const Column<BenchRow>& column : columns_) line.push_back(column.look.*words);
    return line;
  }
  void add(const Line& line) {
    for (std::size_t i = 0; i < line.size(); ++i) width_[i] = std::max(width_[i], line[i].size());
  }

  const TableColumns& columns_;
  std::vector<std::size_t> width_;
  std::vector<bool> left_;
};

}  // namespace

std::string tableText(const BenchResult& result, const Table& table) {
  Lines lines(table.columns);
  std::vector<std::pair<std::string, Line>> shown;  // with the title of each
  for (const BenchRow& row : result.rows) {
    if (std::find(table.parts.begin(), table.parts.end(), textOf(row, "part")) == table.parts.end()) continue;
    shown.emplace_back(table.title ? table.title(row) : "", lines.of(row));
  }
  std::string text;
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const auto& [title, line] = shown[i];
    if (i == 0 || title != shown[i - 1].first) {
      if (!title.empty()) text += (i == 0 ? "" : "\n") + title + "\n";
      text += lines.headText();
    }
    text += lines.text(line);
  }
  return text;
}

std::string cellText(const BenchRow& row, const std::string& key, int width, int digits) {
  const BenchFigure* figure = findFigure(row, key);
  return padded(figure == nullptr ? "" : wordsOf(*figure, digits), static_cast<std::size_t>(std::abs(width)),
                width < 0);
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
