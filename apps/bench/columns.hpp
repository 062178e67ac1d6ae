// SPDX-License-Identifier: Apache-2.0
// apps/bench/columns.hpp: the columns of a bench's rows as data: what a figure is called in JSON and CSV, where it
// comes from, and how the tables on the terminal and on the page show it.
//
// A bench declares its columns once. `addFigures` writes a row by them, which JSON and CSV have as it is; `tableText`
// shows rows by them. A figure that is not finite is null in JSON, empty in CSV and a dash in tables; one that a row
// does not have is empty in CSV and in tables. Any thread; no cost.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "apps/bench/bench_result.hpp"
#include "base/quantile.hpp"

namespace palpate {

// How tables show a figure. Columns stand a blank apart; a wider column parts groups.
struct Look {
  std::string heading = {}, unit = {};  // the head has a line of units where any column has one
  int width = 0;                        // negative: to the left, as words stand; 0: in no table
  int digits = -1;                      // behind the point; -1: as few as it takes
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

// Columns NAME_median_UNIT, NAME_p99_UNIT and so on of the percentiles that `of` gives for a row.
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
    columns.push_back(
        {name + "_" + w.word + "_" + unit, [of, f = w.figure](const Row& row) { return of(row).*f; }, w.look});
  }
  return columns;
}

// Lists, one behind the other.
template <class Any, class... More>
[[nodiscard]] std::vector<Any> joined(std::vector<Any> list, const More&... more) {
  (list.insert(list.end(), more.begin(), more.end()), ...);
  return list;
}

// Of a table: without a function a column has the figure of its key.
using TableColumns = Columns<BenchRow>;

// Those of the columns that tables show.
template <class Row>
[[nodiscard]] TableColumns shown(const Columns<Row>& columns) {
  TableColumns list;
  for (const Column<Row>& column : columns) {
    if (column.look.width != 0) list.push_back({column.key, nullptr, column.look});
  }
  return list;
}

struct Table {
  std::vector<std::string> parts;  // of the rows that are in it
  TableColumns columns;
  std::function<std::string(const BenchRow&)> title{};  // a line, and the head anew, wherever it changes
};

[[nodiscard]] std::string tableText(const BenchResult& result, const Table& table);  // "" without rows

// The figure of `key` alone.
[[nodiscard]] std::string cellText(const BenchRow& row, const std::string& key, int width, int digits = -1);

// Figures of several rows beside each other: a line for each name, in the order in which the names came.
class LineByLine {
 public:
  void add(const std::string& name, const std::string& cell);
  [[nodiscard]] std::string text() const;

 private:
  std::vector<std::pair<std::string, std::string>> lines_;
};

}  // namespace palpate
