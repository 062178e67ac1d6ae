// SPDX-License-Identifier: Apache-2.0
#include "apps/path/path_csv.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "base/error.hpp"
#include "base/outside_text.hpp"
#include "base/quantile.hpp"

namespace palpate {
namespace {

constexpr std::string_view kHeader = "time_s,x_m,y_m,z_m", kHeaderWithBrush = "time_s,x_m,y_m,z_m,brush";
constexpr double kHoleFactor = 10;  // a gap above this many median intervals is a hole

struct NumberedPoint {
  TimedPoint point;
  std::string_view brush;
  std::size_t line = 0;  // in the file, from 1
};

[[noreturn]] void refuseReading(const std::filesystem::path& file) {
  throw Error(Error::Code::kIo, file.string(), "the path file cannot be read",
              "check that it is a file and that you may read it");
}

std::string readAll(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) {
    throw Error(Error::Code::kNotFound, file.string(), "the path file does not exist", "check the name");
  }
  // On Linux a folder can be opened, but reading it throws, and a pipe may be waited for for ever.
  if (!std::filesystem::is_regular_file(file)) refuseReading(file);
  std::ifstream in(file, std::ios::binary);
  if (!in) refuseReading(file);
  std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  return text;
}

// Removes the next line from `text` and returns it without its line end.
std::string_view takeLine(std::string_view& text) {
  const auto end = text.find('\n');
  std::string_view line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

[[noreturn]] void refuseLine(const std::string& file, std::size_t line, const std::string& reason,
                             const std::string& remedy) {
  throw Error(Error::Code::kBadInput, fmt::format("{}, line {}", file, line), reason, remedy);
}

std::string_view withoutBlanks(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

double readNumber(std::string_view text, const std::string& file, std::size_t line) {
  text = withoutBlanks(text);
  double value = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc() || end != text.data() + text.size()) {
    refuseLine(file, line, fmt::format("\"{}\" is not a number", text.substr(0, 40)), "write plain decimal numbers");
  }
  if (!std::isfinite(value)) {
    refuseLine(file, line, fmt::format("{} is not a finite number", text), "remove the row or give its true value");
  }
  return value;
}

// A brush is all that follows the fourth number.
NumberedPoint readRow(std::string_view text, bool with_brush, const std::string& file, std::size_t line) {
  std::array<double, 4> values{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto comma = text.find(',');
    if ((comma == std::string_view::npos) != (i + 1 == values.size() && !with_brush)) {
      refuseLine(
          file, line,
          with_brush ? "a row needs four numbers and a brush, which may be empty" : "a row needs exactly four numbers",
          fmt::format("write {}", with_brush ? kHeaderWithBrush : kHeader));
    }
    values[i] = readNumber(text.substr(0, comma), file, line);
    text.remove_prefix(comma == std::string_view::npos ? text.size() : comma + 1);
  }
  return {{values[0], Vec3(values[1], values[2], values[3])}, withoutBlanks(text), line};
}

std::vector<NumberedPoint> readRows(std::string_view text, bool with_brush, const std::string& file) {
  std::vector<NumberedPoint> rows;
  for (std::size_t line = 2; !text.empty(); ++line) {
    const std::string_view row = takeLine(text);
    if (!row.empty()) rows.push_back(readRow(row, with_brush, file, line));
  }
  return rows;
}

void checkTimesRise(const std::vector<NumberedPoint>& rows, const std::string& file) {
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const double before_s = rows[i - 1].point.time_s, now_s = rows[i].point.time_s;
    if (now_s > before_s) continue;
    refuseLine(
        file, rows[i].line,
        fmt::format("time {} from {} s to {} s", now_s < before_s ? "goes back" : "does not move on", before_s, now_s),
        "sort the rows by time and remove repeated ones");
  }
}

void checkLength(const std::vector<NumberedPoint>& rows, const std::string& file) {
  const double first_s = rows.front().point.time_s, last_s = rows.back().point.time_s;
  if (std::isfinite(last_s - first_s)) return;
  refuseLine(file, rows.back().line,
             fmt::format("the time from {} s to {} s is longer than a number can say", first_s, last_s),
             "give times in seconds");
}

void checkNoHole(const std::vector<NumberedPoint>& rows, const std::string& file) {
  std::vector<double> gaps_s;
  for (std::size_t i = 1; i < rows.size(); ++i) gaps_s.push_back(rows[i].point.time_s - rows[i - 1].point.time_s);
  // The lower median, so that of two unequal gaps the longer one can be a hole.
  const double usual_s = percentiles(gaps_s).p50;
  for (std::size_t i = 0; i < gaps_s.size(); ++i) {
    if (gaps_s[i] <= kHoleFactor * usual_s) continue;
    refuseLine(file, rows[i + 1].line,
               fmt::format("a hole in the path: nothing between {:g} s and {:g} s, where rows come every {:.4g} s",
                           rows[i].point.time_s, rows[i + 1].point.time_s, usual_s),
               "record the path again or fill in the missing rows");
  }
}

}  // namespace

PathFile readPathFile(const std::filesystem::path& file) {
  const std::string name = file.string(), text = readAll(file);
  std::string_view rest = withoutByteOrderMark(text);
  const std::string_view header = takeLine(rest);
  const bool with_brush = header == kHeaderWithBrush;
  if (header != kHeader && !with_brush) {
    refuseLine(name, 1, text.empty() ? "the file is empty" : fmt::format("the header is \"{}\"", header.substr(0, 80)),
               fmt::format("make the first line {}", kHeader));
  }
  const std::vector<NumberedPoint> rows = readRows(rest, with_brush, name);
  if (rows.size() < 2) {
    throw Error(Error::Code::kBadInput, name, fmt::format("a path needs at least two rows, it has {}", rows.size()),
                "add rows of time and position");
  }
  checkTimesRise(rows, name);
  checkLength(rows, name);
  checkNoHole(rows, name);

  PathFile path;
  path.points.reserve(rows.size());
  std::string_view held;
  for (const NumberedPoint& row : rows) {
    path.points.push_back(row.point);
    if (row.brush == held) continue;
    held = row.brush;
    path.brushes.push_back({row.point.time_s - rows.front().point.time_s, std::string(held)});
  }
  return path;
}

std::vector<TimedPoint> readPathCsv(const std::filesystem::path& file) {
  return readPathFile(file).points;
}

}  // namespace palpate
