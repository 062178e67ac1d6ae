// SPDX-License-Identifier: Apache-2.0
// apps/bench/columns.hpp: the columns of a bench's rows as data: the key of a figure in JSON and CSV, the function that
// computes it, and its look in tables. Any thread; no cost.
//
// A bench declares its columns once. addFigures() uses them to write a row, tableText() to show rows as a table. A
// figure that is not finite is a dash in a table; a figure that a row lacks is empty.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "apps/bench/bench_result.hpp"
#include "base/quantile.hpp"

namespace palpate {

// How tables show a figure. Look(): not at all.
struct Look {
  Look() = default;
  Look(std::string head, std::string in, int after_point = -1)
      : heading(std::move(head)), unit(std::move(in)), digits(after_point), is_shown(true) {}

  std::string heading, unit;  // if any column has a unit, a line of units follows the headings
  int digits = -1;            // after the decimal point; -1: as few as needed
  bool is_shown = false;
};

template <class Row>
struct Column {
  std::string key;
  std::function<BenchFigure(const Row&)> figure;  // a pointer to a member, or a function
  Look look = {};
};
template <class Row>
using Columns = std::vector<Column<Row>>;

template <class Row>
void addFigures(BenchRow& row, const Columns<Row>& columns, const Row& of) {
  for (const Column<Row>& column : columns) row.emplace_back(column.key, column.figure(of));
}

// Columns of the percentiles that `of` returns for a row: NAME_median_UNIT, NAME_p99_UNIT and so on.
struct PercentileWord {
  const char* word;
  double Percentiles::*figure;
  Look look = {};
};
template <class Row>
[[nodiscard]] Columns<Row> percentileColumns(const std::string& name, const std::string& unit,
                                             const std::function<Percentiles(const Row&)>& of,
                                             const std::vector<PercentileWord>& words) {
  Columns<Row> columns;
  for (const PercentileWord& w : words) {
    columns.push_back({fmt::format("{}_{}_{}", name, w.word, unit),
                       [of, f = w.figure](const Row& row) { return of(row).*f; }, w.look});
  }
  return columns;
}

// Concatenates lists.
template <class Any, class... More>
[[nodiscard]] std::vector<Any> joined(std::vector<Any> list, const More&... more) {
  (list.insert(list.end(), more.begin(), more.end()), ...);
  return list;
}

// Columns of a table. A column without a function shows the figure of its key.
using TableColumns = Columns<BenchRow>;

// Those of them that tables show.
template <class Row>
[[nodiscard]] TableColumns shown(const Columns<Row>& columns) {
  TableColumns list;
  for (const Column<Row>& column : columns) {
    if (column.look.is_shown) list.push_back({column.key, nullptr, column.look});
  }
  return list;
}

struct Table {
  std::vector<std::string> parts;  // the parts whose rows the table shows
  TableColumns columns;
  std::function<std::string(const BenchRow&)> title{};  // of a row; where it changes, title and headings are repeated
};

// "" without rows. Each column is as wide as its widest cell, one blank apart; texts are aligned to the left.
[[nodiscard]] std::string tableText(const BenchResult& result, const Table& table);

// The figure of `key` in a row, in so many characters; negative: aligned to the left.
[[nodiscard]] std::string cellText(const BenchRow& row, const std::string& key, int width, int digits = -1);

// Puts cells of several rows into one line: a line for each name, in the order in which the names are first added.
class LineByLine {
 public:
  void add(const std::string& name, const std::string& cell);
  [[nodiscard]] std::string text() const;

 private:
  std::vector<std::pair<std::string, std::string>> lines_;
};

}  // namespace palpate
