// SPDX-License-Identifier: Apache-2.0
// apps/bench/bench_result.hpp: the one form in which every bench gives its figures: rows, and a target for each figure
// that the program promises.
//
// JSON: {"bench", "commit", "machine", "vulkan_device", "command", "rows": [...], "targets": [{"name", "value",
// "bound", "holds"}]}. A row is a list of parameters and figures with the unit in the key; rows of one bench may be of
// several kinds, told apart by their first key, "part". A figure that is not finite is null. What a reader must know
// beside the figures (something that was refused or left out) is a row of part "note". Any thread; no cost.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace palpate {

using BenchFigure = std::variant<std::string, double, std::int64_t>;
using BenchRow = std::vector<std::pair<std::string, BenchFigure>>;

// A promise: the value shall be at most the bound.
struct BenchTarget {
  std::string name;  // stable; its unit in it
  double value = 0;
  double bound = 0;
  [[nodiscard]] bool holds() const noexcept { return value <= bound; }  // never for NaN
};

struct BenchResult {
  std::string bench;
  std::string commit;
  std::string machine;
  std::string vulkan_device = "none";
  std::string command;
  std::vector<BenchRow> rows;
  std::vector<BenchTarget> targets;

  void note(const std::string& words) { rows.push_back({{"part", "note"}, {"note", words}}); }
  [[nodiscard]] bool allHold() const noexcept;
};

// Without rows, of this machine, whose processor, memory and system it names.
[[nodiscard]] BenchResult beginBench(const std::string& bench, const std::string& vulkan_device = "none");

// The figure of `key` in a row, nullptr without it.
[[nodiscard]] const BenchFigure* findFigure(const BenchRow& row, std::string_view key);
// It as a number; throws std::out_of_range without it, std::bad_variant_access if it is a text.
[[nodiscard]] double figureOf(const BenchRow& row, std::string_view key);
// The text of `key`, "" without it.
[[nodiscard]] std::string textOf(const BenchRow& row, std::string_view key);

// The rows of a part that have all figures of `like`, in their order. They are part of the result.
using BenchRows = std::vector<const BenchRow*>;
[[nodiscard]] BenchRows rowsOf(const BenchResult& result, std::string_view part, const BenchRow& like = {});

// What is promised of the rows of a part that are like these: the value that `of` makes of all their figures of `keys`.
struct Promise {
  std::string name;
  double bound = 0;
  const char* part = "";
  BenchRow like;
  std::vector<const char*> keys;
  double (*of)(const std::vector<double>& values) = nullptr;
  double up_to_m_per_s = 0;  // rows of faster motion promise nothing; 0: any, or none moves
};
// Adds the target. False where there is no such row, and then no target.
bool promise(BenchResult& result, const Promise& what);

// For `of`: NaN where one of the values is.
[[nodiscard]] double largestOf(const std::vector<double>& values);
[[nodiscard]] double sumOf(const std::vector<double>& values);
[[nodiscard]] double firstOf(const std::vector<double>& values);
[[nodiscard]] double medianOf(const std::vector<double>& values);

// "Intel(R) Xeon(R) Processor, 2 cores, 23.5 GiB, Linux 6.1.0, Debian GNU/Linux 12": the machine that runs this.
[[nodiscard]] std::string machineInWords();

[[nodiscard]] std::string jsonText(const BenchResult& result);
// All rows under one header: the union of their keys, empty where a row has none (RFC 4180).
[[nodiscard]] std::string csvText(const BenchResult& result);
// For the terminal: a line a target, notes, and how many hold.
[[nodiscard]] std::string targetTable(const BenchResult& result);

// A page to read (Markdown), for docs/results.
struct PageWords {
  std::string title;
  std::string introduction;  // what was measured and how, in Markdown
  std::string tables;        // as on the terminal
  std::string chart;         // the picture's name as seen from the page; "" for none
};
[[nodiscard]] std::string benchPage(const BenchResult& result, const PageWords& words);

}  // namespace palpate
