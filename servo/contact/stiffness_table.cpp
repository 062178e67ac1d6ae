// SPDX-License-Identifier: Apache-2.0
#include "servo/contact/stiffness_table.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/formatted.hpp"

namespace palpate {
namespace {

constexpr const char* kInput = "stiffness by density";

[[noreturn]] void refuseTable(const std::string& reason, const char* remedy) {
  throw Error(Error::Code::kBadInput, kInput, reason, remedy);
}

}  // namespace

StiffnessTable::StiffnessTable(std::vector<StiffnessRow> rows) : rows_(std::move(rows)) {
  if (rows_.empty()) refuseTable("the table has no row", "give one or more");
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const StiffnessRow& row = rows_[i];
    if (!std::isfinite(row.density)) refuseTable(formatted("density {}", row.density), "give a finite number");
    if (!(row.factor >= 0 && row.factor <= kLargestFactor)) {
      refuseTable(formatted("factor {} cannot be used", row.factor), "give one from 0 to 100");
    }
    if (i > 0 && !(row.density > rows_[i - 1].density)) {
      refuseTable(formatted("density {} comes after {}", row.density, rows_[i - 1].density),
                  "give the rows in rising order");
    }
  }
}

double StiffnessTable::factor(double density) const noexcept {
  if (!(density > rows_.front().density)) return rows_.front().factor;
  for (std::size_t i = 1; i < rows_.size(); ++i) {
    const StiffnessRow& a = rows_[i - 1];
    const StiffnessRow& b = rows_[i];
    if (density < b.density)
      return a.factor + (b.factor - a.factor) * ((density - a.density) / (b.density - a.density));
  }
  return rows_.back().factor;
}

double StiffnessTable::range() const noexcept {
  const auto [least, most] = std::ranges::minmax(rows_, {}, &StiffnessRow::factor);
  return most.factor - least.factor;
}

}  // namespace palpate
