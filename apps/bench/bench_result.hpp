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

// The figure of `key` in a row; throws std::out_of_range without it, std::bad_variant_access if it is a text.
[[nodiscard]] double figureOf(const BenchRow& row, std::string_view key);
// The text of `key`, "" without it.
[[nodiscard]] std::string textOf(const BenchRow& row, std::string_view key);

// "Intel(R) Xeon(R) Processor, 2 cores, 23.5 GiB, Linux 6.1.0, Debian GNU/Linux 12": the machine that runs this.
[[nodiscard]] std::string machineInWords();

[[nodiscard]] std::string jsonText(const BenchResult& result);
// All rows under one header: the union of their keys, empty where a row has none (RFC 4180).
[[nodiscard]] std::string csvText(const BenchResult& result);
// For the terminal: a line a target, notes, and how many hold.
[[nodiscard]] std::string targetTable(const BenchResult& result);

}  // namespace palpate
