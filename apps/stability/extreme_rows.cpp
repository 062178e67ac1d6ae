// SPDX-License-Identifier: Apache-2.0
#include "apps/stability/extreme_rows.hpp"

#include "apps/extreme/extreme_case.hpp"

namespace palpate {
namespace {

struct ExtremeRow {
  const ExtremeCase* of = nullptr;
  ExtremeOutcome outcome;
};

const Columns<ExtremeRow>& extremeColumns() {
  static const Columns<ExtremeRow> kColumns = {
      {"case", [](const ExtremeRow& row) { return row.of->name; }, {"case", ""}},
      {"expectation", [](const ExtremeRow& row) { return row.of->expectation; }, {"expected", ""}},
      {"not_as_expected",
       [](const ExtremeRow& row) { return std::int64_t{row.outcome.as_expected ? 0 : 1}; },
       {"not so", ""}},
      {"seen", [](const ExtremeRow& row) { return row.outcome.seen; }, {"seen", ""}}};
  return kColumns;
}

}  // namespace

void addExtremeRows(BenchResult& result, const StudyProgress& progress) {
  const std::vector<ExtremeCase>& cases = extremeCases();
  for (std::size_t i = 0; i < cases.size(); ++i) {
    progress(static_cast<double>(i) / static_cast<double>(cases.size()));
    BenchRow row = {{"part", "extreme"}, {"group", cases[i].group}};
    addFigures(row, extremeColumns(), ExtremeRow{&cases[i], outcomeOf(cases[i])});
    result.rows.push_back(std::move(row));
  }
}

void addExtremeTarget(BenchResult& result) {
  promise(result, {.name = "extreme: cases that are not as expected",
                   .bound = 0,
                   .part = "extreme",
                   .keys = {"not_as_expected"},
                   .of = sumOf});
}

Table extremeTable() {
  return {{"extreme"}, shown(extremeColumns()), [](const BenchRow& row) {
            return "\nExtreme cases: " + textOf(row, "group");
          }};
}

}  // namespace palpate
