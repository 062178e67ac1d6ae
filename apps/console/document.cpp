// SPDX-License-Identifier: Apache-2.0
#include "apps/console/document.hpp"

#include <algorithm>
#include <cstdio>
#include <numeric>
#include <sstream>
#include <vector>

#include <sys/ioctl.h>
#include <unistd.h>

#include "apps/console/message.hpp"

namespace palpate {
namespace {

constexpr std::size_t kUsualWidth = 100;  // of a terminal that does not say it [column]
constexpr std::size_t kGap = 2;           // between columns

using Cells = std::vector<std::string>;

// The width of UTF-8 text, with one column for each character.
std::size_t columnsOf(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xc0) != 0x80; }));
}

// "| a | `b` \\| c |": the words between bars that are not escaped.
Cells cellsOf(std::string_view row) {
  Cells cells;
  std::string cell;
  for (std::size_t at = 1; at < row.size(); ++at) {
    const bool is_escaped = row[at] == '\\' && at + 1 < row.size() && row[at + 1] == '|';
    if (row[at] == '|') {
      const std::size_t first = cell.find_first_not_of(' ');
      cells.push_back(first == std::string::npos ? "" : cell.substr(first, cell.find_last_not_of(' ') - first + 1));
      cell.clear();
    } else if (row[at] != '`' && !is_escaped) {
      cell += row[at];
    }
    if (is_escaped) cell += row[++at];
  }
  return cells;
}

bool isRow(std::string_view line) {
  return line.starts_with('|');
}

// "|---|---:|"
bool isRule(std::string_view line) {
  return isRow(line) && line.find('-') != std::string_view::npos &&
         line.find_first_not_of("|-: ") == std::string_view::npos;
}

// Breaks the words of a cell into lines of at most `width` columns; only a single longer word exceeds it.
Cells wrapped(const std::string& cell, std::size_t width) {
  Cells lines(1);
  std::istringstream words(cell);
  for (std::string word; words >> word;) {
    std::string& line = lines.back();
    if (line.empty()) {
      line = word;
    } else if (columnsOf(line) + 1 + columnsOf(word) <= width) {
      line += ' ' + word;
    } else {
      lines.push_back(word);
    }
  }
  return lines;
}

class Table {
 public:
  Table(std::vector<Cells> rows, const Cells& rule) : rows_(std::move(rows)) {
    std::size_t count = rule.size();
    for (const Cells& row : rows_) count = std::max(count, row.size());
    for (Cells& row : rows_) row.resize(count);
    for (std::size_t column = 0; column < count; ++column) {
      to_the_right_.push_back(column < rule.size() && rule[column].ends_with(':') && !rule[column].starts_with(':'));
    }
  }

  [[nodiscard]] std::string text(std::size_t width) const {
    const std::vector<std::size_t> widths = widthsWithin(width);
    std::string out = rowText(rows_.front(), widths);
    Cells rule;
    for (const std::size_t columns : widths) rule.emplace_back(columns, '-');
    out += rowText(rule, widths);
    for (std::size_t row = 1; row < rows_.size(); ++row) out += rowText(rows_[row], widths);
    return out;
  }

 private:
  // The widest column gives way first.
  [[nodiscard]] std::vector<std::size_t> widthsWithin(std::size_t width) const {
    std::vector<std::size_t> widths(to_the_right_.size(), 0), least(widths);
    for (const Cells& row : rows_) {
      for (std::size_t column = 0; column < row.size(); ++column) {
        widths[column] = std::max(widths[column], columnsOf(row[column]));
        for (const std::string& word : wrapped(row[column], 0))
          least[column] = std::max(least[column], columnsOf(word));
      }
    }
    const std::size_t gaps = kGap * (widths.size() - 1);
    while (std::accumulate(widths.begin(), widths.end(), gaps) > width) {
      std::size_t widest = widths.size();
      for (std::size_t column = 0; column < widths.size(); ++column) {
        if (widths[column] == least[column]) continue;
        if (widest == widths.size() || widths[column] > widths[widest]) widest = column;
      }
      if (widest == widths.size()) break;
      --widths[widest];
    }
    return widths;
  }

  [[nodiscard]] std::string rowText(const Cells& row, const std::vector<std::size_t>& widths) const {
    std::vector<Cells> cells;
    std::size_t height = 1;
    for (std::size_t column = 0; column < row.size(); ++column) {
      cells.push_back(wrapped(row[column], widths[column]));
      height = std::max(height, cells.back().size());
    }
    std::string out;
    for (std::size_t line = 0; line < height; ++line) {
      std::string text;
      for (std::size_t column = 0; column < cells.size(); ++column) {
        const std::string words = line < cells[column].size() ? cells[column][line] : "";
        const std::string blanks(widths[column] - std::min(widths[column], columnsOf(words)), ' ');
        if (column > 0) text.append(kGap, ' ');
        text += to_the_right_[column] ? blanks + words : words + blanks;
      }
      text.erase(text.find_last_not_of(' ') + 1);
      out += text + '\n';
    }
    return out;
  }

  std::vector<Cells> rows_;  // the heading first; all of one length
  std::vector<bool> to_the_right_;
};

// The width of standard output [column]; 0 if it is no terminal.
std::size_t terminalWidth() {
  if (isatty(STDOUT_FILENO) != 1) return 0;
  winsize size{};
  const bool is_known = ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return is_known ? size.ws_col : kUsualWidth;
}

}  // namespace

void printDocument(std::string_view document) {
  const std::size_t width = terminalWidth();
  printText(width == 0 ? std::string(document) : alignedTables(document, width));
}

std::string alignedTables(std::string_view document, std::size_t width) {
  std::vector<std::string_view> lines;
  for (std::size_t at = 0; at < document.size();) {
    const std::size_t end = std::min(document.find('\n', at), document.size());
    lines.push_back(document.substr(at, end - at));
    at = end + 1;
  }
  std::string out;
  for (std::size_t line = 0; line < lines.size();) {
    if (!isRow(lines[line]) || line + 1 >= lines.size() || !isRule(lines[line + 1])) {
      out += std::string(lines[line++]) + '\n';
      continue;
    }
    std::vector<Cells> rows = {cellsOf(lines[line])};
    const Cells rule = cellsOf(lines[line + 1]);
    for (line += 2; line < lines.size() && isRow(lines[line]); ++line) rows.push_back(cellsOf(lines[line]));
    out += Table(std::move(rows), rule).text(width);
  }
  if (!document.empty() && document.back() != '\n') out.pop_back();
  return out;
}

}  // namespace palpate
