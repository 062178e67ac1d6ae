// SPDX-License-Identifier: Apache-2.0
// apps/bench/bench_result.hpp: the result of every bench: rows of figures, and a target for each figure that the
// program promises. Also the result as JSON, CSV, text and Markdown. Any thread; no cost.
//
// A row is a list of parameters and figures; the key of a figure holds its unit. A bench may have several kinds of
// rows, which their first key, "part", tells apart. A row of part "note" says what was refused or left out.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace palpate {

using BenchFigure = std::variant<std::string, double, std::int64_t>;
using BenchRow = std::vector<std::pair<std::string, BenchFigure>>;

// What became of a promise: the value that was measured, and the bound that it must not exceed.
struct BenchTarget {
  std::string name;  // with the unit; the same in every version
  double value = 0;
  double bound = 0;
  [[nodiscard]] bool holds() const noexcept { return value <= bound; }  // false for NaN
};

struct BenchResult {
  std::string bench;
  std::string commit;
  std::string machine;
  std::string vulkan_device = "none";
  std::string command;
  std::vector<BenchRow> rows;
  std::vector<BenchTarget> targets;
  bool stopped = false;  // by the user; the rows are what was measured until then

  void note(const std::string& words) { rows.push_back({{"part", "note"}, {"note", words}}); }
  [[nodiscard]] bool allHold() const noexcept;
};

// A result without rows, with the processor, memory and system of this machine.
[[nodiscard]] BenchResult beginBench(const std::string& bench, const std::string& vulkan_device = "none");

// The figure of `key` in a row; nullptr if there is none.
[[nodiscard]] const BenchFigure* findFigure(const BenchRow& row, std::string_view key);
// The number of `key`. Throws std::out_of_range if there is none, std::bad_variant_access if it is a text.
[[nodiscard]] double figureOf(const BenchRow& row, std::string_view key);
// The text of `key`; "" if there is none.
[[nodiscard]] std::string textOf(const BenchRow& row, std::string_view key);

// The number of `key`; empty if there is none, if it is a text or NaN.
[[nodiscard]] std::optional<double> numberIn(const BenchRow& row, std::string_view key);
// Whether a row contains all figures of `like`. 5 and 5.0 are the same.
[[nodiscard]] bool hasAll(const BenchRow& row, const BenchRow& like);

// The rows of a part that contain all figures of `like`, in the result's order. The pointers are into the result.
using BenchRows = std::vector<const BenchRow*>;
[[nodiscard]] BenchRows rowsOf(const BenchResult& result, std::string_view part, const BenchRow& like = {});

// A promise about some rows: rowsOf(result, part, like). All their figures of `keys` go into one list, and `of` makes
// one value of the list. This value must not exceed the bound. A row may lack a figure; a text counts as NaN.
struct Promise {
  std::string name;
  double bound = 0;
  const char* part = "";
  BenchRow like = {};
  std::vector<const char*> keys;
  double (*of)(const std::vector<double>& values) = nullptr;
  double up_to_m_per_s = 0;  // leaves out rows of faster motion; 0: no limit
};
// Adds the promise's target. Returns false, and adds none, if there is no such figure.
bool promise(BenchResult& result, const Promise& what);

// For Promise::of. The largest is NaN if any value is.
[[nodiscard]] double largestOf(const std::vector<double>& values);
[[nodiscard]] double sumOf(const std::vector<double>& values);
[[nodiscard]] double firstOf(const std::vector<double>& values);
[[nodiscard]] double medianOf(const std::vector<double>& values);

// This machine: "Intel(R) Xeon(R) Processor, 2 cores, 23.5 GiB, Linux 6.1.0, Debian GNU/Linux 12".
[[nodiscard]] std::string machineInWords();

// {"bench", "commit", "machine", "vulkan_device", "command", "rows": [...], "targets": [{"name", "value", "bound",
// "holds"}]}. A figure that is not finite is null.
[[nodiscard]] std::string jsonText(const BenchResult& result);
// All rows under one header, the union of their keys. A cell is empty where the row has no such key (RFC 4180).
[[nodiscard]] std::string csvText(const BenchResult& result);
// For the terminal: the notes, a line for each target, and how many targets hold.
[[nodiscard]] std::string targetTable(const BenchResult& result);

// The words around the figures of a page.
struct PageWords {
  std::string title;
  std::string introduction;  // what was measured and how, in Markdown
  std::string tables;        // as on the terminal
  std::string chart;         // file of the chart, relative to the page; "": none
};
// A paragraph as a raw string literal holds it, in one line: without the first line break, each other one a blank.
[[nodiscard]] std::string asParagraph(std::string_view literal);
// The Markdown page for docs/results.
[[nodiscard]] std::string benchPage(const BenchResult& result, const PageWords& words);

}  // namespace palpate
