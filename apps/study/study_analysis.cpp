// SPDX-License-Identifier: Apache-2.0
#include "apps/study/study_analysis.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "apps/bench/columns.hpp"
#include "apps/study/fitted_order.hpp"
#include "apps/study/shard.hpp"

namespace palpate {
namespace {

constexpr double kOrderTolerance = 0.1;

// The rows of the study that have these figures, and numbers under both keys.
BenchRows withBoth(const BenchResult& result, const Study& study, const BenchRow& like, const std::string& x,
                   const std::string& y) {
  BenchRows rows = rowsOf(result, study.name, like);
  std::erase_if(rows, [&](const BenchRow* row) { return !numberIn(*row, x) || !numberIn(*row, y); });
  return rows;
}

void addFront(BenchResult& result, const Study& study, const StudyPlot& plot, const PlottedRows& plotted) {
  std::vector<BenchRow> found;
  for (std::size_t place = 0; place < plotted.front.size(); ++place) {
    const std::size_t i = plotted.front[place];
    found.push_back({{"part", "front"},
                     {"study", study.name},
                     {"plot", plot.title},
                     {"place", static_cast<std::int64_t>(place + 1)},
                     {"series", wordsOf(*plotted.rows[i], plot.series)},
                     {"choice", wordsOf(*plotted.rows[i], plot.labels)},
                     {"cost_of", plot.x_label},
                     {"cost", plotted.at[i].cost},
                     {"error_of", plot.y_label},
                     {"error", plotted.at[i].error}});
  }
  std::move(found.begin(), found.end(), std::back_inserter(result.rows));
}

// Of those that beat the default, the one that gains most: the least product of both ratios.
struct Beaten {
  std::int64_t by = 0, by_rivals = 0;  // choices; those of another series
  std::string best;
  double cost_ratio = 1, error_ratio = 1;  // of the best
};

Beaten beaten(const StudyPlot& plot, const PlottedRows& plotted, std::size_t own) {
  Beaten result;
  for (std::size_t i = 0; i < plotted.rows.size(); ++i) {
    if (!dominates(plotted.at[i], plotted.at[own])) continue;
    ++result.by;
    const bool rival = textOf(*plotted.rows[i], plot.own) != textOf(*plotted.rows[own], plot.own);
    result.by_rivals += rival ? 1 : 0;
    const double cost = plotted.at[i].cost / plotted.at[own].cost, error = plotted.at[i].error / plotted.at[own].error;
    if (result.best.empty() || cost * error < result.cost_ratio * result.error_ratio) {
      result.best = wordsOf(*plotted.rows[i], joined(plot.series, plot.labels));
      result.cost_ratio = cost;
      result.error_ratio = error;
    }
  }
  return result;
}

void addDefault(BenchResult& result, const Study& study, const StudyPlot& plot, const PlottedRows& plotted) {
  if (plot.standard.empty()) return;
  std::vector<BenchRow> found;
  for (std::size_t i = 0; i < plotted.rows.size(); ++i) {
    if (!hasAll(*plotted.rows[i], plot.standard)) continue;
    const Beaten worse = beaten(plot, plotted, i);
    found.push_back({{"part", "default"},
                     {"study", study.name},
                     {"plot", plot.title},
                     {"default", wordsOf(*plotted.rows[i], joined(plot.series, plot.labels))},
                     {"on_front", worse.by == 0 ? "yes" : "no"},
                     {"beaten_by", worse.by},
                     {"beaten_by_rivals", worse.by_rivals},
                     {"best", worse.best},
                     {"cost_ratio", worse.cost_ratio},
                     {"error_ratio", worse.error_ratio}});
  }
  std::move(found.begin(), found.end(), std::back_inserter(result.rows));
}

void addOrders(BenchResult& result, const Study& study, const StudyOrder& order) {
  std::vector<std::pair<std::string, BenchRows>> families;
  for (const BenchRow* row : withBoth(result, study, order.like, order.x, order.y)) {
    const double x = figureOf(*row, order.x);
    if (x < order.least || x > order.most) continue;
    const std::string name = wordsOf(*row, order.family);
    auto at = std::find_if(families.begin(), families.end(), [&](const auto& one) { return one.first == name; });
    if (at == families.end()) at = families.insert(at, {name, {}});
    at->second.push_back(row);
  }
  std::vector<BenchRow> found;
  for (const auto& [name, rows] : families) {
    std::vector<SizeAndError> points;
    for (const BenchRow* row : rows) points.push_back({figureOf(*row, order.x), figureOf(*row, order.y)});
    const double fitted = fittedOrder(points), theory = order.theory(*rows.front());
    if (std::isnan(fitted)) continue;
    found.push_back({{"part", "order"},
                     {"study", study.name},
                     {"what", order.what},
                     {"family", name},
                     {"points", static_cast<std::int64_t>(points.size())},
                     {"fitted_order", fitted},
                     {"theory_order", theory},
                     {"off", std::abs(fitted - theory)}});
  }
  std::move(found.begin(), found.end(), std::back_inserter(result.rows));
}

// The sum of each count over the rows of the same name, and in how many of them it is not 0.
void addCounts(BenchResult& result, const Study& study) {
  std::vector<BenchRow> found;
  for (const std::string& key : study.counts) {
    std::vector<std::pair<std::string, BenchRows>> named;
    for (const BenchRow* row : rowsOf(result, study.name)) {
      if (!numberIn(*row, key)) continue;
      const std::string name = wordsOf(*row, study.counts_by);
      auto at = std::find_if(named.begin(), named.end(), [&](const auto& one) { return one.first == name; });
      if (at == named.end()) at = named.insert(at, {name, {}});
      at->second.push_back(row);
    }
    for (const auto& [name, rows] : named) {
      double sum = 0;
      for (const BenchRow* row : rows) sum += figureOf(*row, key);
      const auto with = std::ranges::count_if(rows, [&](const BenchRow* row) { return figureOf(*row, key) > 0; });
      found.push_back({{"part", "count"},
                       {"study", study.name},
                       {"of", key},
                       {"who", name},
                       {"cells", static_cast<std::int64_t>(rows.size())},
                       {"cells_with", static_cast<std::int64_t>(with)},
                       {"sum", sum}});
    }
  }
  std::move(found.begin(), found.end(), std::back_inserter(result.rows));
}

// The worst of the study's families for which there is a theory.
void promiseOrders(BenchResult& result, const Study& study) {
  std::vector<double> off;
  for (const BenchRow* row : rowsOf(result, "order", {{"study", study.name}})) {
    if (const double by = figureOf(*row, "off"); !std::isnan(by)) off.push_back(by);
  }
  if (off.empty()) return;
  result.targets.push_back(
      {fmt::format("{}: fitted order of convergence off theory's, worst of {} families [-]", study.name, off.size()),
       largestOf(off), kOrderTolerance});
}

// Every cell that was left out or was not reached has no such figure.
void promiseRepeats(BenchResult& result, const Study& study) {
  const BenchRows rows = rowsOf(result, study.name);
  const auto differs = std::count_if(rows.begin(), rows.end(),
                                     [](const BenchRow* row) { return textOf(*row, "errors_repeat") == "no"; });
  result.targets.push_back({fmt::format("{}: cells whose errors differ from round to round [-]", study.name),
                            static_cast<double>(differs), 0});
}

void noteLeftOut(BenchResult& result, const Study& study) {
  std::map<std::string, int> reasons;
  for (const BenchRow* row : rowsOf(result, study.name)) {
    if (const std::string why = textOf(*row, "left_out"); !why.empty()) ++reasons[why];
  }
  for (const auto& [why, cells] : reasons) {
    result.note(
        fmt::format("{}: {} left out: {}", study.name, cells == 1 ? "a cell" : fmt::format("{} cells", cells), why));
  }
}

// Of those that the shards of this result should have.
void noteMissing(BenchResult& result) {
  std::size_t wanted = 0, there = 0;
  for (const BenchRow* shard : rowsOf(result, "shard")) {
    const Shard own{static_cast<int>(figureOf(*shard, "shard")), static_cast<int>(figureOf(*shard, "shards"))};
    wanted += cellsOf(own, static_cast<std::size_t>(figureOf(*shard, "cells"))).size();
  }
  for (const Study& study : studies()) there += rowsOf(result, study.name).size();
  if (there >= wanted) return;
  result.note(
      fmt::format("stopped by the user: {} of {} cells are missing; fronts and orders are those of the rest, some of "
                  "which were measured in fewer rounds than asked for",
                  wanted - there, wanted));
}

}  // namespace

PlottedRows plottedRows(const BenchResult& result, const Study& study, const StudyPlot& plot) {
  PlottedRows plotted;
  plotted.rows = withBoth(result, study, plot.like, plot.x, plot.y);
  for (const BenchRow* row : plotted.rows) plotted.at.push_back({figureOf(*row, plot.x), figureOf(*row, plot.y)});
  if (plot.front) plotted.front = paretoFront(plotted.at);
  return plotted;
}

std::string wordsOf(const BenchRow& row, const std::vector<std::string>& keys) {
  std::string words;
  for (const std::string& key : keys) {
    const BenchFigure* figure = findFigure(row, key);
    if (figure == nullptr) continue;
    const std::string word = std::visit([](const auto& value) { return fmt::format("{}", value); }, *figure);
    if (!word.empty()) words += (words.empty() ? "" : " ") + word;
  }
  return words;
}

bool isQuick(const BenchResult& result) {
  return !rowsOf(result, "shard", {{"quick", "yes"}}).empty();
}

void analyse(BenchResult& result) {
  const bool quick = isQuick(result);
  for (const Study& study : studies()) noteLeftOut(result, study);
  noteMissing(result);
  for (const Study& study : studies()) {
    if (rowsOf(result, study.name).empty()) continue;
    for (const StudyPlot& plot : study.plots(quick)) {
      const PlottedRows plotted = plottedRows(result, study, plot);
      addFront(result, study, plot, plotted);
    }
    for (const StudyPlot& plot : study.plots(quick)) {
      addDefault(result, study, plot, plottedRows(result, study, plot));
    }
    for (const StudyOrder& order : study.orders(quick)) addOrders(result, study, order);
    addCounts(result, study);
    promiseOrders(result, study);
    promiseRepeats(result, study);
    if (study.promise != nullptr) study.promise(result);
  }
}

}  // namespace palpate
