// SPDX-License-Identifier: Apache-2.0
// The tables of `palpate bench error`.
#include <fmt/format.h>

#include "apps/bench/columns.hpp"
#include "apps/study/error_bench.hpp"

namespace palpate {
namespace {

BenchFigure unitOf(const BenchRow& row) {
  return fmt::format("{} | {}", textOf(row, "cost_of"), textOf(row, "error_of"));
}

std::string titleOf(const BenchRow& row) {
  return fmt::format("Pareto front: {}, {}: {}", textOf(row, "study"), textOf(row, "plot"),
                     std::get<std::string>(unitOf(row)));
}

BenchFigure verdictOf(const BenchRow& row) {
  if (textOf(row, "on_front") == "yes") return "on the front";
  const double all = figureOf(row, "beaten_by"), rivals = figureOf(row, "beaten_by_rivals");
  return fmt::format("beaten by {} {}{}, most by {}: {:.2f} of its cost, {:.2f} of its error", all,
                     all == 1 ? "choice" : "choices", rivals > 0 ? fmt::format(" ({} of rivals)", rivals) : "",
                     textOf(row, "best"), figureOf(row, "cost_ratio"), figureOf(row, "error_ratio"));
}

}  // namespace

std::string errorTable(const BenchResult& result) {
  const TableColumns fronts = {{"series", nullptr, {"who", ""}},
                               {"choice", nullptr, {"choice", ""}},
                               {"cost", nullptr, {"cost", "", 4}},
                               {"error", nullptr, {"error", "", 5}}};
  const TableColumns defaults = {{"study", nullptr, {"study", ""}},
                                 {"plot", nullptr, {"plot", ""}},
                                 {"default", nullptr, {"default", ""}},
                                 {"", verdictOf, {"what the front says (cost: along the horizontal axis)", ""}}};
  const TableColumns orders = {{"study", nullptr, {"study", ""}},
                               {"what", nullptr, {"what", ""}},
                               {"family", nullptr, {"family", ""}},
                               {"points", nullptr, {"points", ""}},
                               {"fitted_order", nullptr, {"fitted", "", 3}},
                               {"theory_order", nullptr, {"theory", ""}}};
  const TableColumns counts = {{"study", nullptr, {"study", ""}},
                               {"of", nullptr, {"what", ""}},
                               {"who", nullptr, {"who", ""}},
                               {"sum", nullptr, {"sum", ""}},
                               {"cells_with", nullptr, {"in cells", ""}},
                               {"cells", nullptr, {"of", ""}}};
  std::string text;
  const auto add = [&](const std::string& title, const Table& table) {
    const std::string words = tableText(result, table);
    if (!words.empty()) text += (text.empty() ? "" : "\n") + title + words;
  };
  add("The defaults\n", {{"default"}, defaults});
  add("Orders of convergence\n", {{"order"}, orders});
  add("What went wrong\n", {{"count"}, counts});
  add("", {{"front"}, fronts, titleOf});
  return text;
}

}  // namespace palpate
